// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "clients/client/client.hpp"
#include "clients/client/outgoing.hpp"
#include "clients/client/payload_sender.hpp"
#include "clients/client/spool.hpp"

namespace cairn {

struct Submission::State {
  TransactionKey key;
  std::mutex mutex;
  std::condition_variable changed;
  std::optional<Result<Receipt>> outcome;

  void finish(Result<Receipt> result) {
    {
      const std::lock_guard lock(mutex);
      outcome.emplace(std::move(result));
    }
    changed.notify_all();
  }
};

/// What a source keeps on disk.
struct ClientSpools {
  Spool transactions;
  PayloadSpool payloads;
};

/// What a Client is made of. Three kinds of threads meet here: callers, the link's thread (receipts
/// and everything else that arrives), and the worker, which alone touches the spool and sends
/// transactions. mutex_ guards what they share; callbacks are called without it.
class Client::Engine final : public LinkListener {
 public:
  using Handle = std::shared_ptr<Submission::State>;

  Engine(const ClientOptions& options, std::optional<ClientSpools> spools,
         const MakeLink& make_link);
  ~Engine() override;
  Result<void> start();

  Result<Handle> submit(Transaction transaction);
  Result<ContentHash> send_payload(const std::string& type, const std::string& bytes);
  [[nodiscard]] std::uint64_t unstored_payloads() const;
  Result<void> wait(const Revision& revision, Revision EstimateRevisions::*which,
                    std::chrono::milliseconds timeout);
  Result<std::string> command(const std::string& text, std::chrono::milliseconds timeout);
  [[nodiscard]] std::uint64_t epoch() const { return identity_.epoch; }
  [[nodiscard]] std::uint64_t next_sequence() const;
  [[nodiscard]] std::uint64_t undecided() const;
  /// True on the thread that calls the user's callbacks.
  [[nodiscard]] bool in_callback() const { return std::this_thread::get_id() == callback_thread_; }

  void watch_poses(std::function<void(const PoseUpdate&)> callback);
  void watch_landmarks(
      std::function<void(const EstimateRevisions&, const std::vector<LandmarkChunk>&)> callback);
  void watch_corrections(std::function<void(const Correction&)> callback);
  void watch_maps(std::function<void(const MapChange&)> callback);
  [[nodiscard]] std::vector<MapView> maps() const;
  void look_at_map_from(double x_m, double y_m);
  void watch_status(std::function<void(const Status&)> callback);
  void watch_events(std::function<void(const Event&)> callback);
  void watch_refusals(std::function<void(const Receipt&)> callback);
  void watch_trouble(std::function<void(const Error&)> callback);

  void on_receipt(Receipt receipt) override;
  void on_source_state(SourceState state) override;
  void on_payload_receipt(PayloadReceipt receipt) override;
  void on_poses(EstimateRevisions revisions, std::vector<PoseChunk> chunks) override;
  void on_landmarks(EstimateRevisions revisions, std::vector<LandmarkChunk> chunks) override;
  void on_correction(Correction correction) override;
  void on_status(Status status) override;
  void on_event(Event event) override;
  void on_reply(Reply reply) override;
  void on_tile_index(TileBlock block) override;
  void on_tiles(TileAnswer answer) override;
  void on_trouble(Error error) override;

 private:
  struct Taken {  // by submit(), not yet on disk
    std::string bytes;
    Handle handle;
  };
  using Waiting = std::map<std::uint64_t, Handle>;
  using Lock = std::unique_lock<std::mutex>;

  void work();
  [[nodiscard]] bool has_work(Outgoing::Clock::time_point now) const;
  void wait_for_work(Lock& lock);
  void spool_taken(Lock& lock);
  void fail_taken(const std::vector<Handle>& batch, const Error& error);
  void send_next(Lock& lock);
  void send_due();
  void remember_promise(Lock& lock);
  [[nodiscard]] Outgoing::Clock::time_point next_telling() const;  // under mutex_
  void tell_daemon();
  void tell(Error error);
  void prune_maps();
  void tell_of_map(const MapChange& change);  // under callbacks_
  void tell_refusal(const Receipt& receipt);

  ClientOptions options_;
  Link::Identity identity_;
  std::unique_ptr<Link> link_;
  std::unique_ptr<PayloadSender> payloads_;  // null without a source
  std::unique_ptr<MapFollower> maps_;        // null where no maps are followed
  std::thread worker_;
  std::atomic<std::thread::id> callback_thread_{};

  mutable std::mutex mutex_;
  std::condition_variable work_;     // for the worker
  std::condition_variable arrived_;  // estimates and replies
  std::optional<Spool> spool_;       // the worker's, once it runs
  std::uint64_t oldest_kept_ = 1;    // the spool's, for other threads
  std::uint64_t spool_bytes_ = 0;
  std::uint64_t taken_bytes_ = 0;
  std::uint64_t first_of_run_ = 1;
  std::uint64_t next_sequence_ = 1;
  std::uint64_t last_spooled_ = 0;
  std::deque<Taken> taken_;
  Waiting waiting_;  // for their receipts
  Outgoing outgoing_;
  std::optional<SourceState> daemon_;  // nothing: not heard of, so nothing is sent
  std::uint64_t released_ = 0;
  Spool::Promise promise_;
  Spool::Promise remembered_;  // of the worker
  Outgoing::Clock::time_point told_daemon_{};
  bool news_for_daemon_ = true;
  bool foreign_ = false;  // another program has our name, and the user knows it
  bool damaged_ = false;  // the next record to send is, and the user knows it
  bool stopping_ = false;

  std::optional<EstimateRevisions> estimate_;
  std::uint64_t commands_ = 0;
  std::map<std::uint64_t, std::optional<Reply>> replies_;

  // Callbacks, and what a callback that comes late must see. Held while they run.
  std::mutex callbacks_;
  std::function<void(const PoseUpdate&)> pose_callback_;
  std::function<void(const EstimateRevisions&, const std::vector<LandmarkChunk>&)>
      landmark_callback_;
  std::function<void(const Correction&)> correction_callback_;
  std::function<void(const MapChange&)> map_callback_;
  std::function<void(const Status&)> status_callback_;
  std::function<void(const Event&)> event_callback_;
  std::function<void(const Receipt&)> refusal_callback_;
  std::function<void(const Error&)> trouble_callback_;
  std::map<std::pair<OdometryFrame, std::uint32_t>, PoseChunk> poses_;
  std::map<std::pair<OdometryFrame, std::uint32_t>, LandmarkChunk> landmarks_;
  std::map<OdometryFrame, Correction> corrections_;
  std::optional<EstimateRevisions> pose_revisions_, landmark_revisions_;
  std::optional<Status> status_;
};

}  // namespace cairn
