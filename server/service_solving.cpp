// SPDX-License-Identifier: BSD-3-Clause
// Solves beside the deciding thread, on snapshots of the map.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "cairn/history/solve_trouble.hpp"
#include "cairn/replay/estimate_snapshot.hpp"
#include "server/service.hpp"

namespace cairn {
namespace {

// Of the solver's thread: who takes transactions and answers goes first.
constexpr int kNiceness = 10;

// What odometry does not foresee: where it has led to may be wrong from now on.
bool may_move_the_past(const Transaction& transaction) {
  return !transaction.edits.empty() ||
         std::any_of(transaction.factors.begin(), transaction.factors.end(),
                     [](const NewFactor& f) { return f.kind != FactorKind::kOdometry; });
}

}  // namespace

bool Service::needs_solve() const {
  const PoseGraph& map = head_.graph();
  if (map.factors.size() == 0) return false;
  return !settled_ || refill_.active() || map.solved_revision.number < head_.last_input();
}

// Of the record that comes as `number`. A solve of all of it, which may take long, is begun again
// later: what has come goes first.
void Service::note_news(const Transaction& transaction, std::uint64_t number) {
  if (!may_move_the_past(transaction)) return;
  news_at_ = number;
  if (awaiting_solution_.empty()) give_way_ = true;
}

bool Service::awaits_live_solve() const {
  return news_at_ > solving_from_ && !solver_works_ && !solving_ && !refill_.active();
}

void Service::solve_when_due() {
  const auto now = std::chrono::steady_clock::now();
  const bool idle = now - last_input_ >= options_.solve_after_pause;
  if (disk_ == DiskSpace::kFull) return refuse_to_solve();
  if (solver_works_ || solving_ || refill_.active()) return;
  // What could not be solved is tried again when something has changed, or when somebody asks.
  const bool hopeless = unsolvable_ == head_.last_input();
  if (needs_solve() && ((idle && !hopeless) || settle_next_ || !awaiting_solution_.empty()))
    start_solve(SolveKind::kSettled);
  else if (awaits_live_solve() && now >= solve_began_ + options_.solve_every)
    start_solve(SolveKind::kLive);
  else if (trust_is_due(idle))
    measure_trust_beside();
  else if (idle)
    write_snapshot_when_due();
  if (idle && !solver_works_ && !solving_) thin_when_due();
}

// The result could not be kept.
void Service::refuse_to_solve() {
  for (const Command& command : std::exchange(awaiting_solution_, {}))
    transport_.reply({command.key, ErrorCode::kNotUsable,
                      "storage full: under 2 % of the daemon's disk is free; make room there"});
}

void Service::start_solve(SolveKind kind) {
  const bool gives_way = kind == SolveKind::kSettled && !settle_next_;
  solving_ = true;
  solving_kind_ = kind;
  give_way_ = false;
  solving_from_ = head_.graph().graph_revision.number;
  solve_began_ = std::chrono::steady_clock::now();
  settle_next_ &= kind != SolveKind::kSettled;
  const SolveMethod method{kind, options_.loops_that_merge};
  on_solver_thread([this, method, gives_way, base = head_.graph(),
                    input = head_.last_input()]() -> std::optional<Message> {
    WorkBudget work(1e9 * static_cast<double>(options_.solve_work));
    SettleOptions how;
    how.keep_going = [this, gives_way] {
      pass(ServicePoint::kSolving);
      return !abandon_solve_ && !(gives_way && give_way_);
    };
    how.eliminations = &eliminations_;
    if (method.kind == SolveKind::kLive) how.work = &work;
    pass(ServicePoint::kSolving);  // a start that is the solution has no iterations
    return Message(std::make_unique<Solved>(
        Solved{method, base.graph_revision, input, solve_as(method, base, how)}));
  });
}

// The work before has ended.
void Service::on_solver_thread(std::function<std::optional<Message>()> work) {
  if (solver_.joinable()) solver_.join();
  solver_works_ = true;
  solver_work_ = std::move(work);
  solver_ = std::thread([this] {
    (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNiceness);
    std::optional<Message> found = solver_work_();
    {
      const std::lock_guard lock(mutex_);
      solver_works_ = false;
      if (found) inbox_.push_back(std::move(*found));
    }
    wake_.notify_all();
  });
}

// What a start need not take from the solves before. Written by the solver's thread: nobody waits.
void Service::write_snapshot_when_due() {
  const bool due = head_.graph().graph_revision.number >= snapshot_at_ + options_.snapshot_every;
  if (!chi2_ || needs_solve() || !due) return;
  snapshot_at_ = head_.graph().graph_revision.number;
  on_solver_thread([this, map = head_.graph(), chi2 = *chi2_]() -> std::optional<Message> {
    write_snapshot(map, chi2);
    return std::nullopt;
  });
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
  const MapSolution& solution = solved.solution;
  const SolveSummary& whole = solution.whole;
  if (whole.stop_reason == StopReason::kInterrupted) return;
  if (whole.stop_reason == StopReason::kWorkLimit) return settle_instead();
  if (solution.usable()) {
    if (is_news(head_.graph(), solution, solved.method.kind, solved.last_input) &&
        !commit_solution(solved))
      return;
    chi2_ = solution.chi2;
    publish_estimate();
    note_solved_closures(solved.base.number);
    state_changed_ = true;
  }
  settled_ = whole.usable() && solved.method.kind == SolveKind::kSettled;
  tell_trouble(solution);
  if (!whole.usable()) {
    unsolvable_ = solved.last_input;
    for (const Command& command : std::exchange(awaiting_solution_, {}))
      transport_.reply({command.key, ErrorCode::kNotUsable, unsettled_text(whole)});
    return;
  }
  for (const Command& command : std::exchange(awaiting_solution_, {})) carry_out(command);
}

// Loops that came wait, pending, for a solve that takes as long as it needs.
void Service::settle_instead() {
  settle_next_ = true;
  announce(Severity::kInfo, "solve_deferred",
           "a live solve would take more than " + std::to_string(options_.solve_work) +
               "e9 multiplications (solve: work_limit): the map is settled next",
           head_.graph().graph_revision);
}

void Service::tell_trouble(const MapSolution& solution) {
  const Revision& at = head_.graph().graph_revision;
  std::set<std::uint32_t> broken;
  for (const UnsolvedPart& part : solution.unsolved) {
    broken.insert(part.worst_factor);
    if (!broken_.contains(part.worst_factor) || !awaiting_solution_.empty())
      announce(Severity::kError, "solve_failed", describe(part, head_, journal_), at);
  }
  broken_ = std::move(broken);
  std::set<NodeIndex> free;
  for (const FreeNode& node : solution.free) free.insert(node.node);
  if (free == std::exchange(free_, free) || free.empty()) return;
  announce(Severity::kWarning, "under_constrained", describe(solution.free, head_, journal_), at);
}

bool Service::commit_solution(const Solved& solved) {
  Revision next = journal_.head().revision;
  ++next.number;
  const std::vector<RecordBody> records =
      apply_solution(head_, solved.base, solved.solution, next, solved.method);
  pass(ServicePoint::kBeforeCommit);
  const Result<Revision> appended = journal_.append(records);
  pass(ServicePoint::kCommitted);
  if (!appended) {
    fall_back(appended.error());
    return false;
  }
  for (VerdictRecord& verdict : verdict_records(head_.graph(), solved.solution))
    if (FactorName name = verdict.factor; verdict.state == FactorState::kQuarantined)
      quarantined_.insert_or_assign(std::move(name), std::move(verdict));
    else
      quarantined_.erase(name);
  for (const LoopVerdict& verdict : solved.solution.verdicts) tell_verdict(verdict);
  return true;
}

// What goes the usual way is not told: a loop closure came, and fits.
void Service::tell_verdict(const LoopVerdict& verdict) {
  const StoredFactor& factor = head_.graph().factors[verdict.factor];
  const bool was_told = told_verdicts_.contains(verdict.factor);
  if (verdict.state == FactorState::kCommitted && !was_told) return;
  constexpr const char* kKinds[] = {"loop_pending", "loop_committed", "loop_quarantined"};
  Event event;
  event.severity =
      verdict.state == FactorState::kQuarantined ? Severity::kWarning : Severity::kInfo;
  event.kind = kKinds[static_cast<int>(verdict.state)];
  event.revision = head_.graph().graph_revision;
  event.factor = factor.name;
  event.text = describe(verdict, head_);
  if (verdict.state == FactorState::kCommitted)
    told_verdicts_.erase(verdict.factor);
  else
    told_verdicts_.insert(verdict.factor);
  announce(std::move(event));
}

}  // namespace cairn
