// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "cairn/history/solve_record.hpp"
#include "clients/client/client.hpp"
#include "server/memory_transport.hpp"
#include "server/service.hpp"
#include "tests/server/drive.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn::test {

/// A service that solves while input goes on, and a client that watches its poses.
class LiveService : public testing::Test {
 protected:
  explicit LiveService(const JournalOptions& options = {})
      : journal_(*Journal::open((folder_.path() / "data").string(), options)) {}
  // Input never pauses for so long that the map would be settled.
  void start(ServiceOptions options = {}) {
    options.solve_after_pause = std::chrono::hours(1);
    options.publish_every = std::chrono::milliseconds(1);
    options.on_event = [this, tell = options.on_event](const Event& event) {
      if (tell) tell(event);
      const std::lock_guard lock(mutex_);
      events_.push_back(event);
    };
    service_.emplace(*journal_, *transport_, options);
    ASSERT_TRUE(service_->start());
    client_.emplace(*Client::connect(
        {.source = "test", .robot = "robot", .spool = folder_.path() / "spool"},
        [this](Link::Identity identity) { return network_.make_link(std::move(identity)); }));
    client_->on_poses([this](const PoseUpdate& update) {
      const std::lock_guard lock(mutex_);
      for (const PoseChunk& chunk : update.chunks) {
        map_of_[chunk.frame.robot] = chunk.map;
        if (chunk.frame.robot != kLeader) continue;
        for (const auto& pose : chunk.poses) x_[pose.index] = pose.T_map_body[0];
      }
    });
  }
  Revision submit(const Transaction& step) {
    const Result<Receipt> receipt = client_->submit(step, std::chrono::seconds(10));
    EXPECT_TRUE(receipt) << receipt.error().to_string();
    if (!receipt) return {};
    EXPECT_FALSE(receipt->refusal) << receipt->reason;
    return receipt->revision;
  }
  double x(std::uint64_t index) {
    const std::lock_guard lock(mutex_);
    return x_.at(index);
  }
  std::string map_of(const std::string& robot) {
    const std::lock_guard lock(mutex_);
    return map_of_[robot];
  }
  std::vector<Event> events(const std::string& kind) {
    const std::lock_guard lock(mutex_);
    std::vector<Event> found;
    for (const Event& event : events_)
      if (event.kind == kind) found.push_back(event);
    return found;
  }
  template <class Body>
  std::vector<Body> records() const {
    std::vector<Body> found;
    EXPECT_TRUE(journal_->for_each(1, [&](const Record& record) -> Result<void> {
      if (const auto* body = std::get_if<Body>(&record.body)) found.push_back(*body);
      return {};
    }));
    return found;
  }
  std::vector<SolveRecord> solves() const { return records<SolveRecord>(); }

  TemporaryFolder folder_;
  MemoryNetwork network_;
  std::unique_ptr<Journal> journal_;
  std::unique_ptr<Transport> transport_ = network_.make_transport();
  std::optional<Service> service_;
  std::mutex mutex_;
  std::map<std::uint64_t, double> x_;          ///< of the leader, by node
  std::map<std::string, std::string> map_of_;  ///< by robot
  std::vector<Event> events_;
  std::optional<Client> client_;
};

}  // namespace cairn::test
