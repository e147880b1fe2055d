// SPDX-License-Identifier: BSD-3-Clause
#include "server/service.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <utility>

#include "cairn/history/solve_record.hpp"
#include "cairn/replay/estimate_snapshot.hpp"
#include "server/replay_journal.hpp"

namespace cairn {
namespace {

std::int64_t wall_clock_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::uint64_t resident_bytes() {
  std::ifstream statistics("/proc/self/statm");
  std::uint64_t all = 0, resident = 0;
  statistics >> all >> resident;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

Service::Service(Journal& journal, Transport& transport, ServiceOptions options)
    : journal_(journal),
      transport_(transport),
      options_(options),
      sequencer_(options.limits),
      publisher_(transport) {}

Service::~Service() { stop(); }

Result<void> Service::start() {
  started_ns_ = wall_clock_ns();
  if (auto replayed = rebuild(); !replayed) return replayed;
  if (auto started = transport_.start(*this); !started) return started;
  last_input_ = std::chrono::steady_clock::now();
  publish_state();
  publisher_.publish(head_.graph());
  decider_ = std::thread([this] { run(); });
  return {};
}

bool Service::stop(std::optional<std::chrono::milliseconds> patience) {
  transport_.stop();
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  abandon_solve_ = true;
  wake_.notify_all();
  if (decider_.joinable()) decider_.join();
  if (patience) {
    std::unique_lock lock(mutex_);
    if (!wake_.wait_for(lock, *patience, [this] { return !solver_works_; })) return false;
  }
  if (solver_.joinable()) solver_.join();
  // A start right after this one finds everything solved.
  const std::uint64_t end = head_.graph().graph_revision.number;
  if (chi2_ && !needs_solve() && !journal_.failed() && end > std::exchange(snapshot_at_, end))
    write_snapshot(head_.graph(), *chi2_);
  return true;
}

std::optional<Error> Service::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

Result<void> Service::rebuild() {
  head_ = MapHead();
  sequencer_ = Sequencer(options_.limits);
  const Result<Replayed> replayed =
      replay_journal(journal_, head_, sequencer_, [this] { pass(ServicePoint::kReplayingRecord); });
  if (!replayed) return replayed.error();
  chi2_ = replayed->chi2;
  snapshot_at_ = replayed->snapshot;
  return {};
}

void Service::pass(ServicePoint point) const {
  if (options_.on_point) options_.on_point(point);
}

void Service::on_transaction(Transaction transaction, const Sender& sender) {
  post(Arrived{make_arrival(std::move(transaction)), sender});
}
void Service::on_unreadable_transaction(UnreadableTransaction transaction, const Sender& sender) {
  Arrival arrival;
  arrival.transaction.key = std::move(transaction.key);
  arrival.hash = transaction.content;
  arrival.bytes = sizeof(Arrival) + transaction.reason.size();
  arrival.fault = Refusal{transaction.code, std::move(transaction.reason)};
  post(Arrived{std::move(arrival), sender});
}
void Service::on_client(ClientState client, const Sender& /*sender*/) { post(std::move(client)); }
void Service::on_source_lost(std::string /*source*/, const Sender& /*sender*/) {}
void Service::on_payload(Payload payload, const Sender& /*sender*/) {
  transport_.publish(PayloadReceipt{payload.source, payload.epoch, payload.number, payload.hash,
                                    PayloadAnswer::kRefused,
                                    "this version of the daemon keeps no payloads"});
}
void Service::on_command(Command command) { post(std::move(command)); }
void Service::on_rival(Status rival) {
  if (rival.started_ns < started_ns_)
    fail({ErrorCode::kUsage, "another daemon serves this domain: stop it, or take another domain",
          rival.host});
}
void Service::on_trouble(Error error) {
  announce(Severity::kWarning, "transport", error.to_string());
}

void Service::announce(Severity severity, std::string kind, std::string text,
                       const Revision& revision) {
  Event event;
  event.number = ++events_;
  event.time_ns = wall_clock_ns();
  event.severity = severity;
  event.kind = std::move(kind);
  event.revision = revision;
  event.text = std::move(text);
  if (options_.on_event) options_.on_event(event);
  transport_.publish(event);
}

void Service::post(Message message) {
  {
    const std::lock_guard lock(mutex_);
    inbox_.push_back(std::move(message));
  }
  wake_.notify_one();
}

void Service::fail(Error error) {
  const std::lock_guard lock(mutex_);
  if (!failure_) failure_ = std::move(error);
}

void Service::run() {
  while (true) {
    std::deque<Message> messages;
    {
      std::unique_lock lock(mutex_);
      wake_.wait_for(lock, options_.solve_after_pause,
                     [this] { return stopping_ || !inbox_.empty(); });
      if (stopping_) return;
      messages.swap(inbox_);
    }
    watch_disk();
    if (!messages.empty()) handle(std::move(messages));
    solve_when_idle();
  }
}

void Service::refuse_for_now(const TransactionKey& key) {
  transport_.publish(Receipt{key, journal_.head().revision, RefusalCode::kStorageFull,
                             "under 2 % of the daemon's disk is free: make room there"});
}

// Once a second. A full disk is no end: clients keep what they have, and try again.
void Service::watch_disk() {
  const auto now = std::chrono::steady_clock::now();
  if (now - disk_watched_ < std::chrono::seconds(1)) return;
  disk_watched_ = now;
  const DiskSpace before = std::exchange(disk_, journal_.space());
  if (disk_ == before) return;
  const Revision& head = head_.graph().graph_revision;
  if (disk_ == DiskSpace::kPlenty) {
    announce(Severity::kInfo, "disk", "more than 10 % of the disk is free again", head);
  } else if (disk_ == DiskSpace::kLow) {
    announce(Severity::kWarning, "disk",
             "under 10 % of the disk is free; under 2 % nothing more is taken", head);
  } else {
    announce(Severity::kError, "disk",
             "under 2 % of the disk is free: nothing is taken until there is room", head);
  }
  publish_state();
}

// Everything that came while the disk was busy shares one sync.
void Service::handle(std::deque<Message> messages) {
  Sequencer::Outcome outcome;
  Revision next = journal_.head().revision;
  ++next.number;
  std::vector<std::unique_ptr<Solved>> solutions;
  std::vector<Command> commands;
  std::vector<ClientState> clients;
  for (Message& message : messages) {
    if (auto* arrived = std::get_if<Arrived>(&message)) {
      if (disk_ == DiskSpace::kFull) {
        refuse_for_now(arrived->arrival.transaction.key);
        continue;
      }
      sequencer_.take(std::move(arrived->arrival), arrived->sender.arrived_ns, head_, next,
                      outcome);
      last_input_ = std::chrono::steady_clock::now();
    } else if (auto* command = std::get_if<Command>(&message)) {
      commands.push_back(std::move(*command));
    } else if (auto* client = std::get_if<ClientState>(&message)) {
      clients.push_back(std::move(*client));
    } else {
      solutions.push_back(std::move(std::get<std::unique_ptr<Solved>>(message)));
    }
  }
  sequencer_.expire(wall_clock_ns(), head_, next, outcome);
  commit(std::move(outcome));
  for (const ClientState& client : clients) greet(client);
  for (const auto& solved : solutions) take_solution(*solved);
  for (const Command& command : commands) carry_out(command);
}

void Service::commit(Sequencer::Outcome outcome) {
  if (!outcome.decisions.empty()) {
    std::vector<Receipt> receipts;
    std::vector<RecordBody> records;
    Revision revision = journal_.head().revision;
    const std::int64_t now = wall_clock_ns();
    for (Decision& decision : outcome.decisions) {
      ++revision.number;
      receipts.push_back({decision.transaction.key, revision, decision.refusal, decision.reason});
      records.push_back(record_of(std::move(decision), now));
    }
    pass(ServicePoint::kBeforeCommit);
    const Result<Revision> appended = journal_.append(records);
    pass(ServicePoint::kCommitted);
    if (!appended) {
      // Nothing of it happened: back to what the disk has. What waits is sent again as well.
      if (journal_.failed()) fail(appended.error());
      const Revision head = journal_.head().revision;
      const std::string reason = appended.error().to_string();
      receipts.insert(receipts.end(), outcome.answers.begin(), outcome.answers.end());
      for (const Receipt& receipt : receipts)
        transport_.publish(Receipt{receipt.key, head, RefusalCode::kStorageFull, reason});
      for (const Receipt& receipt : sequencer_.turn_away(RefusalCode::kStorageFull, reason, head))
        transport_.publish(receipt);
      if (auto rebuilt = rebuild(); !rebuilt) fail(rebuilt.error());
      return;
    }
    for (const Receipt& receipt : receipts) transport_.publish(receipt);
  }
  for (const Receipt& answer : outcome.answers) transport_.publish(answer);
  if (outcome.decisions.empty()) return;
  publisher_.publish(head_.graph());
  publish_state();
}

// A client sends nothing before it knows what was decided.
void Service::greet(const ClientState& client) {
  const JournalHead head = journal_.head();
  SourceState state;
  state.source = client.source;
  state.epoch = client.epoch;
  state.revision = head.revision;
  state.chain = head.chain;
  state.highest_decided = sequencer_.highest_decided(client.source, client.epoch);
  transport_.publish(state);
}

void Service::publish_state() {
  const JournalHead head = journal_.head();
  Status status;
  status.started_ns = started_ns_;
  status.version = "0.1.0";
  char host[256] = "";
  gethostname(host, sizeof(host) - 1);
  status.host = std::string(host) + ", process " + std::to_string(getpid());
  status.state = DaemonState::kServing;
  status.head = head.revision;
  status.estimate = {head_.graph().graph_revision, head_.graph().solved_revision};
  status.variables = head_.graph().nodes.size();
  status.factors = head_.graph().factors.size();
  status.chi2 = chi2_.value_or(0.0);
  status.memory_bytes = resident_bytes();
  status.disk_free_bytes = journal_.free_bytes();
  if (disk_ != DiskSpace::kPlenty) status.message = "the disk is nearly full";
  for (const auto& [name, counters] : sequencer_.counters()) {
    transport_.publish(
        SourceState{name, counters.epoch, counters.highest_decided, head.revision, head.chain});
    SourceStatus source;
    source.source = name;
    source.epoch = counters.epoch;
    source.highest_decided = counters.highest_decided;
    source.accepted = counters.accepted;
    source.refused = counters.refused;
    source.held = counters.held;
    source.last_refusal = counters.last_refusal;
    status.sources.push_back(std::move(source));
  }
  transport_.publish(status);
}

// A solve's own record comes right after what it has seen.
bool Service::needs_solve() const {
  const PoseGraph& map = head_.graph();
  if (map.factors.size() == 0) return false;
  return !chi2_ || map.solved_revision.number + 1 < map.graph_revision.number;
}

void Service::solve_when_idle() {
  const bool idle = std::chrono::steady_clock::now() - last_input_ >= options_.solve_after_pause;
  if (solver_works_ || solving_) return;
  if (needs_solve() && (idle || !awaiting_solution_.empty()))
    start_solve();
  else if (idle)
    write_snapshot_when_due();
}

void Service::start_solve() {
  solving_ = true;
  on_solver_thread([this, base = head_.graph()] {
    const auto keep_going = [this] {
      pass(ServicePoint::kSolving);
      return !abandon_solve_;
    };
    post(std::make_unique<Solved>(Solved{base, settle(base, keep_going)}));
  });
}

// The work before has ended.
void Service::on_solver_thread(std::function<void()> work) {
  if (solver_.joinable()) solver_.join();
  solver_works_ = true;
  solver_ = std::thread([this, work = std::move(work)] {
    work();
    {
      const std::lock_guard lock(mutex_);
      solver_works_ = false;
    }
    wake_.notify_all();
  });
}

// What a start need not take from the solves before. Written by the solver's thread: nobody waits.
void Service::write_snapshot_when_due() {
  const bool due = head_.graph().graph_revision.number >= snapshot_at_ + options_.snapshot_every;
  if (!chi2_ || needs_solve() || !due) return;
  snapshot_at_ = head_.graph().graph_revision.number;
  on_solver_thread([this, map = head_.graph(), chi2 = *chi2_] { write_snapshot(map, chi2); });
}

void Service::write_snapshot(const PoseGraph& map, double chi2) {
  pass(ServicePoint::kBeforeSnapshot);
  const auto written =
      journal_.write_snapshot(map.graph_revision.number, encode_snapshot(map, chi2));
  pass(ServicePoint::kSnapshotWritten);
  if (!written) announce(Severity::kWarning, "snapshot_failed", written.error().to_string());
}

void Service::take_solution(const Solved& solved) {
  solving_ = false;
  const SolveSummary& summary = solved.settled.summary;
  if (!summary.usable()) {
    if (summary.stop_reason == StopReason::kInterrupted) return;
    announce(Severity::kError, "solve_failed",
             "the last good estimate stays: " + std::string(to_string(summary.stop_reason)),
             solved.base.graph_revision);
    return;
  }
  const auto changed = changed_estimates(head_.graph(), solved.settled);
  const Revision base = solved.base.graph_revision;
  if (!changed.empty() || head_.graph().solved_revision.number + 1 < base.number) {
    if (!commit_solution(base, changed)) return;
  }
  chi2_ = summary.final_chi2;
  publisher_.publish(head_.graph());
  publish_state();
  for (const Command& command : std::exchange(awaiting_solution_, {})) carry_out(command);
}

bool Service::commit_solution(const Revision& base,
                              const std::vector<std::pair<NodeIndex, Estimate>>& changed) {
  Revision next = journal_.head().revision;
  ++next.number;
  const std::vector<RecordBody> records{apply_solve(head_, base, changed, next)};
  pass(ServicePoint::kBeforeCommit);
  const Result<Revision> appended = journal_.append(records);
  pass(ServicePoint::kCommitted);
  if (appended) return true;
  if (journal_.failed()) fail(appended.error());
  if (auto rebuilt = rebuild(); !rebuilt) fail(rebuilt.error());
  return false;
}

void Service::carry_out(const Command& command) {
  Reply reply;
  reply.key = command.key;
  if (command.text == "settle") {
    if (needs_solve()) {
      const bool repeated =
          std::any_of(awaiting_solution_.begin(), awaiting_solution_.end(),
                      [&](const Command& waiting) { return waiting.key == command.key; });
      if (!repeated) awaiting_solution_.push_back(command);
      return;
    }
    char chi2[32];
    std::snprintf(chi2, sizeof(chi2), "%.9g", chi2_.value_or(0.0));
    reply.text = "settled at " + to_string(head_.graph().graph_revision) + ", chi2 " + chi2;
  } else {
    reply.error = ErrorCode::kUsage;
    reply.text = "unknown command '" + command.text + "'; known: settle";
  }
  transport_.reply(reply);
}

}  // namespace cairn
