// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "clients/client/dds_link.hpp"
#include "clients/client/spool.hpp"
#include "server/sequencer.hpp"

namespace cairn::test {

/// By source and sequence: the record that a receipt named.
using Receipted = std::map<std::pair<std::string, std::uint64_t>, std::uint64_t>;

/// Sends whole spools again, as a client would that has forgotten everything, and keeps the
/// answers.
class Resender final : public LinkListener {
 public:
  static constexpr std::uint64_t kStale = 0;  ///< in place of a record's number

  Resender(std::uint32_t domain, const std::string& source, const std::filesystem::path& folder)
      : source_(source), spool_(*Spool::open({.folder = folder, .source = source})) {
    link_ = make_dds_link({.domain = domain}, {source, spool_.epoch(), 1});
  }
  ~Resender() override { link_->stop(); }

  Receipted run() {
    EXPECT_TRUE(link_->start(*this));
    introduce(0);
    constexpr std::uint64_t kWindow = 200;
    for (std::uint64_t first = spool_.oldest_kept(); first < spool_.next_sequence();
         first += kWindow) {
      const std::uint64_t end = std::min(first + kWindow, spool_.next_sequence());
      const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
      while (missing(first, end) && std::chrono::steady_clock::now() < deadline) {
        send(first, end);
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
      }
      EXPECT_FALSE(missing(first, end)) << source_ << ": no answer to " << first << " to " << end;
    }
    const std::lock_guard lock(mutex_);
    return answers_;
  }

 private:
  void introduce(std::int64_t daemon_ns) {
    EXPECT_TRUE(link_->send(
        ClientState{.source = source_, .epoch = spool_.epoch(), .daemon_ns = daemon_ns}));
  }
  bool missing(std::uint64_t first, std::uint64_t end) {
    const std::lock_guard lock(mutex_);
    for (; first < end && answers_.contains({source_, first}); ++first) {
    }
    return first < end;
  }
  void send(std::uint64_t first, std::uint64_t end) {
    introduce(daemon_ns_);  // each time: the daemon may have known the client before still
    for (std::uint64_t sequence = first; sequence < end; ++sequence) {
      const auto bytes = spool_.read(sequence);
      ASSERT_TRUE(bytes) << bytes.error().to_string();
      ASSERT_TRUE(link_->send(*decode_transaction(*bytes)));
    }
  }
  void on_receipt(Receipt receipt) override {
    if (receipt.refusal && is_retryable(*receipt.refusal)) return;  // the lease of the one before
    // Of what was decided long ago the daemon knows no more than that (long soak runs). An old copy
    // of a spool does not know how long.
    const bool long_ago =
        receipt.key.sequence + SequencerLimits{}.kept_decisions <= highest_decided_;
    const bool stale = long_ago && receipt.refusal == RefusalCode::kStale;
    EXPECT_TRUE(!receipt.refusal || stale) << receipt.reason;
    const std::lock_guard lock(mutex_);
    answers_[{receipt.key.source, receipt.key.sequence}] = stale ? kStale : receipt.revision.number;
  }
  void on_source_state(SourceState state) override {
    daemon_ns_ = state.daemon_ns;
    highest_decided_ = state.highest_decided;
  }
  void on_payload_receipt(PayloadReceipt) override {}
  void on_poses(EstimateRevisions, std::vector<PoseChunk>) override {}
  void on_landmarks(EstimateRevisions, std::vector<LandmarkChunk>) override {}
  void on_correction(Correction) override {}
  void on_status(Status) override {}
  void on_event(Event) override {}
  void on_reply(Reply) override {}
  void on_trouble(Error error) override { ADD_FAILURE() << error.to_string(); }

  std::string source_;
  Spool spool_;
  std::unique_ptr<Link> link_;
  std::atomic<std::int64_t> daemon_ns_{0};
  std::atomic<std::uint64_t> highest_decided_{0};
  std::mutex mutex_;
  Receipted answers_;
};

}  // namespace cairn::test
