// SPDX-License-Identifier: BSD-3-Clause
#include "server/service.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <utility>

#include "cairn/core/wall_clock.hpp"
#include "cairn/history/solve_record.hpp"
#include "cairn/replay/estimate_snapshot.hpp"
#include "server/replay_journal.hpp"
#include "server/status_json.hpp"

namespace cairn {

Service::Service(Journal& journal, Transport& transport, ServiceOptions options)
    : journal_(journal),
      transport_(transport),
      options_(options),
      sequencer_(options.limits),
      desk_(journal, transport) {}

Service::~Service() { stop(); }

Result<void> Service::start() {
  started_ns_ = wall_clock_ns();
  started_ = std::chrono::steady_clock::now();
  if (auto replayed = rebuild(); !replayed) return replayed;
  if (auto started = transport_.start(*this); !started) return started;
  payloads_.start();
  maps_.start(started_ns_);
  last_input_ = std::chrono::steady_clock::now();
  announce_opening();
  const OpenReport& report = journal_.open_report();
  if (report.damage || report.cut_tail) refill_.begin(Refill::Clock::now());
  publish_state();
  publish_estimate();
  decider_ = std::thread([this] { run(); });
  return {};
}

bool Service::stop(std::optional<std::chrono::milliseconds> patience) {
  transport_.stop();
  payloads_.stop();
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  abandon_solve_ = true;
  wake_.notify_all();
  if (decider_.joinable()) decider_.join();
  maps_.stop();
  if (!desk_.stop(patience)) return false;
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
  // Of which store an empty map is, its estimate says, too.
  if (head_.graph().graph_revision.number == 0) head_.pass_over(journal_.head().revision);
  chi2_ = replayed->chi2;
  settled_ = chi2_.has_value();
  news_at_ = solving_from_ = unsolvable_ = 0;
  told_verdicts_.clear();
  for (std::uint32_t place = 0; place < head_.graph().factors.size(); ++place)
    if (head_.graph().factors[place].state == FactorState::kQuarantined)
      told_verdicts_.insert(place);
  quarantined_ = replayed->quarantined;
  closures_.clear();
  snapshot_at_ = replayed->snapshot;
  return {};
}

// To what the disk has. What waits is sent again as well.
void Service::fall_back(const Error& error) {
  if (journal_.failed()) fail(error);
  transport_.publish_receipts(
      sequencer_.turn_away(RefusalCode::kStorageFull, error.to_string(), journal_.head().revision));
  if (auto rebuilt = rebuild(); !rebuilt) fail(rebuilt.error());
}

void Service::pass(ServicePoint point) const {
  if (options_.on_point) options_.on_point(point);
}

// The newcomer hears of the other at once. Clocks tell only which of two newcomers was first.
void Service::on_rival(Status rival) {
  constexpr std::chrono::seconds kNew{5};
  const bool we_are_new = std::chrono::steady_clock::now() - started_ < kNew;
  const bool both_are_new =
      std::abs(rival.started_ns - started_ns_) < std::chrono::nanoseconds(kNew).count();
  if (we_are_new && (!both_are_new || rival.started_ns < started_ns_)) {
    fail({ErrorCode::kUsage, "another daemon serves this domain: stop it, or take another domain",
          rival.host});
  }
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
      // Work of the solver's thread that leaves no message ends, too, and something may wait for
      // it.
      wake_.wait_for(lock, until_next_duty(), [this] {
        return stopping_ || !inbox_.empty() || (solver_work_ && !solver_works_);
      });
      if (stopping_) return;
      messages.swap(inbox_);
      inbox_bytes_ = 0;
    }
    if (!solver_works_) solver_work_ = nullptr;
    watch_disk();
    if (journal_.failed()) fail({ErrorCode::kInternal, "the disk does not keep what is written"});
    if (!messages.empty()) handle(std::move(messages));
    publish_estimate_when_due();
    end_refill();
    publish_state();
    solve_when_due();
  }
}

// Everything that came while the disk was busy shares one sync.
void Service::handle(std::deque<Message> messages) {
  decided_.clear();
  Sequencer::Outcome outcome;
  std::vector<std::unique_ptr<Solved>> solutions;
  std::optional<Thinned> thinned;
  bool map_is_wanted = false;
  std::vector<Command> commands;
  std::vector<ClientState> clients;
  for (Message& message : messages) {
    if (auto* arrived = std::get_if<Arrived>(&message)) {
      take(std::move(*arrived), outcome);
    } else if (auto* command = std::get_if<Command>(&message)) {
      commands.push_back(std::move(*command));
    } else if (auto* seen = std::get_if<Seen>(&message)) {
      meet(*seen, outcome);
      clients.push_back(std::move(seen->client));
    } else if (auto* lost = std::get_if<Lost>(&message)) {
      part(*lost);
    } else if (auto* brought = std::get_if<Brought>(&message)) {
      bring(std::move(*brought));
    } else if (const auto* heard = std::get_if<Heard>(&message)) {
      writers_.hear_of(heard->spool);
    } else if (std::holds_alternative<MapWanted>(message)) {
      map_is_wanted = true;
    } else if (auto* read = std::get_if<MapRead>(&message)) {
      read->graph = {};  // before anything is written
    } else if (auto* planned = std::get_if<Thinned>(&message)) {
      thinned = std::move(*planned);
    } else {
      solutions.push_back(std::move(std::get<std::unique_ptr<Solved>>(message)));
    }
  }
  sequencer_.expire(turn(outcome));
  commit(std::move(outcome));
  for (const ClientState& client : clients) greet(client);
  let_strangers_go(writers_.remove_excess_strangers());
  for (const auto& solved : solutions) take_solution(*solved);
  if (thinned) take_out(*thinned);
  if (map_is_wanted) show_map();
  for (const Command& command : commands) carry_out(command);
}

// Patience is measured by a clock that nobody sets.
Sequencer::Turn Service::turn(Sequencer::Outcome& outcome) {
  const std::int64_t now_ns =
      std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
  Revision next = journal_.head().revision;
  ++next.number;
  return {now_ns, head_, next, outcome};
}

void Service::take(Arrived arrived, Sequencer::Outcome& outcome) {
  const TransactionKey& key = arrived.arrival.transaction.key;
  std::optional<Refusal> refusal = writers_.refuse(key, arrived.sender);
  if (!refusal) refusal = refill_.refuse(key);
  if (key.source == kOwnSource)
    refusal = Refusal{RefusalCode::kForeignSource,
                      std::string("the name ") + kOwnSource + " is the daemon's own: take another"};
  if (disk_ == DiskSpace::kFull)
    refusal = Refusal{RefusalCode::kStorageFull,
                      "under 2 % of the daemon's disk is free: make room there"};
  if (refusal) {
    outcome.answers.push_back({key, head_.graph().graph_revision, refusal->code, refusal->reason});
    sequencer_.count_refusal(outcome.answers.back());
    return;
  }
  sequencer_.take(std::move(arrived.arrival), turn(outcome));
  decided_.resize(outcome.decisions.size(), arrived.at);
  last_input_ = std::chrono::steady_clock::now();
}

void Service::commit(Sequencer::Outcome outcome) {
  if (!outcome.decisions.empty()) {
    std::vector<Receipt> receipts;
    std::vector<RecordBody> records;
    std::vector<std::pair<TransactionKey, ContentHash>> named;
    Revision revision = journal_.head().revision;
    const std::int64_t now = wall_clock_ns();
    for (Decision& decision : outcome.decisions) {
      ++revision.number;
      receipts.push_back({decision.transaction.key, revision, decision.refusal, decision.reason});
      note_news(decision.transaction, revision.number);
      if (news_at_ == revision.number && receipts.size() <= decided_.size())
        closures_.emplace_back(revision.number, decided_[receipts.size() - 1]);
      for (const NewFactor& factor : decision.transaction.factors)
        for (const ContentHash& hash : factor.payloads)
          named.emplace_back(decision.transaction.key, hash);
      records.push_back(record_of(std::move(decision), now));
    }
    pass(ServicePoint::kBeforeCommit);
    const Result<Revision> appended = journal_.append(records);
    pass(ServicePoint::kCommitted);
    if (!appended) {
      // Nothing of it happened, and what it has led to is not said.
      receipts.insert(receipts.end(), outcome.answers.begin(), outcome.answers.end());
      for (Receipt& receipt : receipts)
        receipt = {receipt.key, journal_.head().revision, RefusalCode::kStorageFull,
                   appended.error().to_string()};
      transport_.publish_receipts(receipts);
      fall_back(appended.error());
      return;
    }
    transport_.publish_receipts(receipts);
    note_answered(receipts.size());
    for (const Receipt& receipt : receipts) {
      changed_spools_.emplace(receipt.key.source, receipt.key.epoch);
      refill_.decided(receipt.key, Refill::Clock::now());
    }
    for (const auto& [key, hash] : named) payloads_.expect({key.source, key.epoch}, hash);
  }
  if (!outcome.answers.empty()) transport_.publish_receipts(outcome.answers);
  state_changed_ |= !outcome.decisions.empty() || !outcome.answers.empty();
  estimate_changed_ |= !outcome.decisions.empty();
}

std::chrono::nanoseconds Service::until_next_duty() const {
  auto due = std::chrono::steady_clock::time_point::max();
  if (estimate_changed_) due = published_at_ + options_.publish_every;
  if (awaits_live_solve()) due = std::min(due, solve_began_ + options_.solve_every);
  return std::clamp<std::chrono::nanoseconds>(due - std::chrono::steady_clock::now(),
                                              std::chrono::nanoseconds(0),
                                              options_.solve_after_pause);
}

// Growth by odometry is told now and then: each time the last chunk of a trajectory goes out whole.
void Service::publish_estimate_when_due() {
  if (estimate_changed_ &&
      std::chrono::steady_clock::now() >= published_at_ + options_.publish_every)
    publish_estimate();
}

void Service::publish_estimate() {
  publisher_.publish(head_.graph());
  published_at_ = std::chrono::steady_clock::now();
  estimate_changed_ = false;
  maps_.hear_of_news();
}

// Of what is published: nothing else is in it as long as nothing has come since.
void Service::show_map() {
  maps_.show({head_.graph(), publisher_.map_of_frames(), settled_ && !needs_solve()});
}

}  // namespace cairn
