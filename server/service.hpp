// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <variant>

#include "cairn/history/solve_record.hpp"
#include "cairn/history/source_trust.hpp"
#include "cairn/journal/journal.hpp"
#include "cairn/replay/thinning.hpp"
#include "server/commands.hpp"
#include "server/estimate_publisher.hpp"
#include "server/latency_window.hpp"
#include "server/map_service.hpp"
#include "server/payload_store.hpp"
#include "server/refill.hpp"
#include "server/sequencer.hpp"
#include "server/transport.hpp"
#include "server/writers.hpp"

namespace cairn {

/// Moments in a service's life at which a process can be killed with different results.
enum class ServicePoint {
  kReplayingRecord,
  kBeforeCommit,
  kCommitted,  ///< and nobody told
  kSolving,    ///< before the first iteration and between two
  kMeasuringTrust,
  kBeforeSnapshot,
  kSnapshotWritten,
};

struct ServiceOptions {
  /// The map is settled when nothing has come for so long. Loops and other news are solved at once.
  std::chrono::milliseconds solve_after_pause{200};
  /// But at most so often: each solve leaves a record of what it moved.
  std::chrono::milliseconds solve_every{50};
  /// What such a solve may compute, in units of 1e9 multiplications (about a second each); what
  /// takes more waits until the map is settled, which comes next then.
  std::int64_t solve_work = 10;
  /// So many loop closures tie two robots, or two odometry epochs, into one map.
  std::size_t loops_that_merge = kLoopsThatMerge;
  /// Poses are marginalized out of the map where so many newer visits came by (1: at least one);
  /// 0: never.
  std::size_t thin_after_visits = 0;
  int thin_radius_cm = 100, thin_angle_deg = 30;  ///< what came by: so near
  /// A correction that moves a robot further than this raises an event before it is published.
  int jump_cm = 100, jump_deg = 10;
  /// Poses that came are published together, at most so often.
  std::chrono::milliseconds publish_every{10};
  /// Estimates are stored beside the journal after so many records, so that a start need not apply
  /// all solves.
  std::uint64_t snapshot_every = 10'000;
  /// States of sources and of the daemon are published so often, where they have changed.
  std::chrono::milliseconds state_every{1000};
  /// What has arrived and was not looked at yet; beyond, it is refused for now.
  std::size_t inbox_bytes = 256u << 20;
  SequencerLimits limits{};
  Refill::Patience refill{};
  PayloadStore::Options payloads{};
  MapService::Options maps{};
  /// Told what is published as an event, for the log. From any thread.
  std::function<void(const Event&)> on_event{};
  /// For tests that end the process there. From any thread.
  std::function<void(ServicePoint)> on_point{};
};

/// Whose transactions those are that the daemon makes itself.
inline constexpr const char* kOwnSource = ".cairnd";

/// The daemon without its process: takes transactions from a transport, makes them durable, answers
/// them, solves when a loop closes and when input pauses, and publishes estimates. One thread
/// decides and writes, one solves on snapshots at a lower priority; nobody waits for the solver.
class Service final : private TransportListener {
 public:
  /// Both must outlive the service.
  Service(Journal& journal, Transport& transport, ServiceOptions options = {});
  ~Service() override;
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  /// Replays the journal, publishes the estimate, then begins to listen.
  Result<void> start();
  /// A running solve is abandoned; it has changed nothing. Without `patience` it is waited for;
  /// else false where it did not end in that time: then nothing is left to do but to end the
  /// process.
  bool stop(std::optional<std::chrono::milliseconds> patience = {});
  /// What ended the service by itself, such as a disk that does not sync.
  [[nodiscard]] std::optional<Error> failure() const;

 private:
  struct Arrived {
    Arrival arrival;
    Sender sender;
    std::chrono::steady_clock::time_point at{};
  };
  struct Seen {
    ClientState client;
    Sender sender;
  };
  struct Lost {
    std::string source;
    std::uint64_t writer;
  };
  struct Brought {
    Payload payload;
    Sender sender;
    std::string fault{};  ///< why it cannot be read; empty: it can
  };
  struct Heard {
    Writers::Spool spool;  ///< was answered without a look at what it said
  };
  struct MapWanted {};  ///< a snapshot for the map service
  struct MapRead {
    PoseGraph graph;  ///< that was its snapshot
  };
  struct Thinned {
    std::uint64_t last_input;  ///< of the map that it was planned for
    Thinning plan;
  };
  struct Solved {
    SolveMethod method;
    Revision base;
    std::uint64_t last_input;  ///< there
    MapSolution solution;
  };
  using Message = std::variant<Arrived, Seen, Lost, Brought, Heard, Command, MapWanted, MapRead,
                               Thinned, std::unique_ptr<Solved>>;

  void on_transaction(Transaction transaction, const Sender& sender) override;
  void on_unreadable_transaction(UnreadableTransaction transaction, const Sender& sender) override;
  void on_client(ClientState client, const Sender& sender) override;
  void on_source_lost(std::string source, const Sender& sender) override;
  void on_payload(Payload payload, const Sender& sender) override;
  void on_unreadable_payload(Payload payload, std::string reason, const Sender& sender) override;
  void on_command(Command command) override;
  void on_tile_request(TileRequest request) override;
  void on_rival(Status rival) override;
  void on_trouble(Error error) override;

  void post(Message message);
  void post(Arrival arrival, const Sender& sender);
  void post(Brought brought);
  [[nodiscard]] bool admit(Message&& message, std::size_t bytes, std::size_t room = 0);
  void answered_unread(const Writers::Spool& spool);
  void run();
  void announce_opening();
  [[nodiscard]] std::chrono::nanoseconds until_next_duty() const;
  void publish_estimate_when_due();
  void publish_estimate();
  void show_map();
  void watch_disk();
  void handle(std::deque<Message> messages);
  [[nodiscard]] Sequencer::Turn turn(Sequencer::Outcome& outcome);
  void take(Arrived arrived, Sequencer::Outcome& outcome);
  void meet(const Seen& seen, Sequencer::Outcome& outcome);
  void hear_promise(const ClientState& client);
  void bring(Brought brought);
  void part(const Lost& lost);
  void end_refill();
  void commit(Sequencer::Outcome outcome);
  void let_strangers_go(const std::vector<Writers::Spool>& spools);
  void greet(const ClientState& client);
  void take_solution(const Solved& solved);
  void settle_instead();
  void tell_trouble(const MapSolution& solution);
  void tell_jump(const Correction& correction);
  bool commit_solution(const Solved& solved);
  void tell_verdict(const LoopVerdict& verdict);
  void carry_out(const Command& command);
  void obey(const Command& command, const Question& question);
  [[nodiscard]] bool needs_solve() const;
  void note_news(const Transaction& transaction, std::uint64_t number);
  void solve_when_due();
  [[nodiscard]] bool awaits_live_solve() const;
  void refuse_to_solve();
  void start_solve(SolveKind kind);
  void on_solver_thread(std::function<std::optional<Message>()> work);
  void thin_when_due();
  void take_out(const Thinned& thinned);
  void write_snapshot_when_due();
  void write_snapshot(const PoseGraph& map, double chi2);
  void announce(Severity severity, std::string kind, std::string text,
                const Revision& revision = {});
  void announce(Event event);
  void pass(ServicePoint point) const;
  void publish_state();
  [[nodiscard]] Status make_status() const;
  [[nodiscard]] nlohmann::ordered_json status_json() const;
  void note_answered(std::size_t decisions);
  void note_solved_closures(std::uint64_t base);
  [[nodiscard]] bool trust_is_due(bool idle) const;
  void measure_trust_beside();
  Result<void> rebuild();
  void fall_back(const Error& error);
  void fail(Error error);

  Journal& journal_;
  Transport& transport_;
  ServiceOptions options_;

  // Of the deciding thread.
  MapHead head_;
  Sequencer sequencer_;
  Writers writers_{[this](const Writers::Spool& spool) {
    return sequencer_.highest_decided(spool.first, spool.second);
  }};
  EstimatePublisher publisher_{transport_,
                               {.m = 0.01 * options_.jump_cm,
                                .rad = options_.jump_deg * std::numbers::pi / 180.0,
                                .tell = [this](const Correction& c) { tell_jump(c); }}};
  CommandDesk desk_;
  std::chrono::steady_clock::time_point last_input_{};
  std::vector<Command> awaiting_solution_;
  std::chrono::steady_clock::time_point started_{};
  std::int64_t started_ns_ = 0;
  bool estimate_changed_ = false;  ///< since it was published
  std::chrono::steady_clock::time_point published_at_{};
  std::string damage_;  ///< that was found at the start
  DiskSpace disk_ = DiskSpace::kPlenty;
  std::chrono::steady_clock::time_point disk_watched_{};
  std::optional<double> chi2_;      ///< of the last solve, where this process knows it
  bool settled_ = false;            ///< the last solve was kept to the bit, and by this process
  std::uint64_t news_at_ = 0;       ///< the last record that a solve is to follow at once
  std::uint64_t solving_from_ = 0;  ///< the last record that a solve has seen, or now sees
  std::chrono::steady_clock::time_point solve_began_{};
  std::uint64_t thinned_at_ = 0;   ///< the last input of the map in which nothing is redundant
  bool settle_next_ = false;       ///< a live solve was too much work
  EliminationCache eliminations_;  ///< of the solver: one solve runs at a time
  SolveKind solving_kind_ = SolveKind::kSettled;  ///< of the running solve
  std::uint64_t unsolvable_ = 0;  ///< the last input of the map of which the last solve failed
  std::set<std::uint32_t> told_verdicts_;  ///< loop closures of which was told that they are out
  std::map<FactorName, VerdictRecord> quarantined_;  ///< why; also of some that were disabled since
  std::set<NodeIndex> free_;                         ///< nodes of which was told that they are free
  std::set<std::uint32_t> broken_;  ///< factors of which was told that they cannot be solved
  std::uint64_t snapshot_at_ = 0;   ///< the record that the newest snapshot is after
  PayloadStore payloads_{
      journal_, transport_, options_.payloads,
      [this](Severity severity, const std::string& text) { announce(severity, "payloads", text); },
      [this] { maps_.hear_of_payload(); }};
  MapService maps_{
      journal_,
      transport_,
      options_.maps,
      {.ask_for_snapshot = [this] { post(MapWanted{}); },
       .give_back = [this](PoseGraph graph) { post(MapRead{std::move(graph)}); },
       .tell = [this](Severity severity,
                      const std::string& text) { announce(severity, "map_full", text); }}};
  Refill refill_{options_.refill};
  int eras_raised_ = 0;                      ///< by clients' receipts
  std::set<Writers::Spool> changed_spools_;  ///< their state is to be published
  bool state_changed_ = true;
  std::chrono::steady_clock::time_point state_published_{};
  std::vector<std::chrono::steady_clock::time_point>
      decided_;  ///< when what this turn decided came
  LatencyWindow receipt_latency_, closure_latency_;
  /// Records that a solve is to follow at once, and when they came.
  std::deque<std::pair<std::uint64_t, std::chrono::steady_clock::time_point>> closures_;
  std::uint64_t trust_at_ = 0;  ///< the solve of which it was measured
  std::chrono::steady_clock::time_point trust_began_{};

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable wake_;
  std::deque<Message> inbox_;
  std::size_t inbox_bytes_ = 0;
  std::chrono::steady_clock::time_point trouble_told_{};
  std::uint64_t troubles_untold_ = 0;
  bool stopping_ = false;
  std::optional<Error> failure_;
  std::vector<SourceTrust> trust_;

  std::atomic<std::uint64_t> events_{0};
  std::atomic<bool> abandon_solve_{false};
  std::atomic<bool> give_way_{false};      ///< news has come: a solve of everything can wait
  std::atomic<bool> solver_works_{false};  ///< written under mutex_
  bool solving_ = false;                   ///< of the deciding thread
  /// What it does, with the snapshot for it. Taken away by the deciding thread: who drops a
  /// snapshot elsewhere says nothing to the thread that changes the map.
  std::function<std::optional<Message>()> solver_work_;
  std::thread solver_;
  std::thread decider_;
};

}  // namespace cairn
