// SPDX-License-Identifier: BSD-3-Clause
#include "server/reexecution.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cairn/history/apply_record.hpp"
#include "cairn/history/order.hpp"
#include "cairn/linear/platform.hpp"
#include "cairn/replay/estimate.hpp"
#include "cairn/replay/estimate_snapshot.hpp"
#include "cairn/replay/solve_map.hpp"

namespace cairn {
namespace {

constexpr double kTolerance = 1e-9;  // relative, where bits cannot be compared

Error differs(std::uint64_t number, const std::string& what) {
  return {ErrorCode::kBadInput, what, "record " + std::to_string(number)};
}

// Made by a method that is not known here, or where numbers round in another way.
bool rounds_otherwise(const SolveRecord& record) {
  const SolveSettings made = SolveSettings::parse(record.settings);
  const std::optional<SolveMethod> method = made.known();
  return !method || made != SolveSettings::here(*method);
}

// Relative to the larger number, or to one meter or radian.
double difference(const Estimate& a, const Estimate& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double scale = std::max({1.0, std::abs(a[i]), std::abs(b[i])});
    largest = std::max(largest, std::abs(a[i] - b[i]) / scale);
  }
  return largest;
}

}  // namespace

// The limits of the daemon that decided are not known, and none was exceeded.
Reexecution::Reexecution(const Journal& journal)
    : journal_(journal),
      sequencer_({.sources = ~std::size_t{0},
                  .never_accepted = ~std::size_t{0},
                  .closed_epochs = ~std::size_t{0}}) {}

Result<Reexecuted> Reexecution::run(const OnRecord& on_record) {
  if (Result<void> found = find_bases(); !found) return found.error();
  snapshot_ = journal_.newest_snapshot();
  HeadHash hash;
  const Result<void> walked = journal_.for_each(1, [&](const Record& record) -> Result<void> {
    if (Result<void> executed = execute(record); !executed) return executed;
    ++result_.records;
    if (Result<void> alike = check_snapshot(record.number); !alike) return alike;
    const PoseGraph& map = head_.graph();
    if (uses_of_base_.contains(record.number)) bases_.emplace(record.number, map);
    if (!on_record) return {};
    const auto* transaction = std::get_if<TransactionRecord>(&record.body);
    const auto* accepted =
        transaction == nullptr ? nullptr : std::get_if<Transaction>(&transaction->outcome);
    if (accepted != nullptr && accepted->edits.empty())
      hash.grow(map);
    else
      hash.update(map);
    on_record(record, hash.value());
    return {};
  });
  if (!walked) return walked.error();
  hash.update(head_.graph());
  result_.head_hash = hash.value();
  return result_;
}

// Which states of the map solves will ask for.
Result<void> Reexecution::find_bases() {
  return journal_.for_each(1, [&](const Record& record) -> Result<void> {
    if (const auto* solve = std::get_if<SolveRecord>(&record.body)) ++uses_of_base_[solve->base];
    return {};
  });
}

Result<void> Reexecution::execute(const Record& record) {
  const Revision revision{journal_.head().revision.store, record.era, record.number};
  // Damage leaves verdicts without the solve that found them, and raises the era.
  if (std::exchange(era_, record.era) != record.era) verdicts_.clear();
  if (const auto* transaction = std::get_if<TransactionRecord>(&record.body))
    return execute(*transaction, revision);
  if (const auto* solve = std::get_if<SolveRecord>(&record.body)) return execute(*solve, record);
  if (const auto* verdict = std::get_if<VerdictRecord>(&record.body)) {
    ++result_.verdicts;
    verdicts_.push_back(*verdict);
    return apply_record(record, revision.store, head_);
  }
  verdicts_.clear();
  if (const auto* command = std::get_if<CommandRecord>(&record.body)) {
    ++result_.commands;
    if (Result<void> same = order_again(*command, revision); !same) return same;
  }
  return apply_record(record, revision.store, head_);
}

Result<void> Reexecution::execute(const TransactionRecord& record, const Revision& revision) {
  if (const auto* transaction = std::get_if<Transaction>(&record.outcome)) {
    ++result_.accepted;
    return decide_again(*transaction, record, revision);
  }
  // What was refused is not kept, only why: its number must be free.
  ++result_.refused;
  const auto& refused = std::get<RefusedTransaction>(record.outcome);
  if (refused.key.sequence <= sequencer_.highest_decided(refused.key.source, refused.key.epoch)) {
    return differs(revision.number, "sequence " + std::to_string(refused.key.sequence) + " of " +
                                        refused.key.source + " was decided before");
  }
  sequencer_.replay(refused.key, record.content_hash, refused.code, refused.reason, revision);
  head_.advance(revision);
  return {};
}

Result<void> Reexecution::decide_again(const Transaction& transaction,
                                       const TransactionRecord& record, const Revision& revision) {
  Sequencer::Outcome outcome;
  const Sequencer::Turn turn{record.arrival_ns, head_, revision, outcome};
  const TransactionKey& key = transaction.key;
  if (const auto before = sequencer_.highest_decided(key.source, key.epoch);
      key.sequence > before + 1) {
    result_.gaps.push_back("record " + std::to_string(revision.number) + ": sequences " +
                           std::to_string(before + 1) + " to " + std::to_string(key.sequence - 1) +
                           " of " + key.source + " are missing");
    sequencer_.skip_to(key.source, key.epoch, key.sequence, turn);
  }
  sequencer_.take(make_arrival(transaction), turn);
  const std::string name =
      "transaction " + transaction.key.source + '/' + std::to_string(transaction.key.sequence);
  if (outcome.decisions.size() != 1) {
    const std::string why = outcome.answers.empty()
                                ? "it would wait for an earlier one or for another source"
                                : outcome.answers.front().reason;
    return differs(revision.number,
                   name + " was accepted, but executed again it is not decided: " + why);
  }
  const Decision& decision = outcome.decisions.front();
  if (decision.refusal) {
    return differs(revision.number,
                   name + " was accepted, but executed again it is refused: " + decision.reason);
  }
  if (decision.content_hash != record.content_hash)
    return differs(revision.number, name + " does not have the hash of what was sent");
  return {};
}

Result<void> Reexecution::order_again(const CommandRecord& record, const Revision& revision) {
  const auto order = order_of(record);
  if (!order || !*order) return {};  // what cannot be read is told when it is applied
  const auto question = Question::parse((*order)->asked);
  if (!question || !is_order(*question)) return differs(revision.number, "it orders nothing known");
  const auto again = make_order(*question, journal_, head_);
  if (!again) return differs(revision.number, "ordered again: " + again.error().to_string());
  if (to_record(*again, *question, 0).command == record.command) return {};
  return differs(revision.number, "ordered again it changes other factors");
}

Result<void> Reexecution::execute(const SolveRecord& record, const Record& whole) {
  if (Result<void> solved = solve_again(record, whole.number); !solved) return solved;
  verdicts_.clear();
  if (Result<void> applied = apply_record(whole, journal_.head().revision.store, head_); !applied)
    return applied;
  // Poses that came during the solve were composed onto it, which rounds like the solve.
  if (rounds_otherwise(record) || hash_estimates(head_.graph()) == record.estimates_hash) return {};
  return differs(whole.number, "the estimates after this solve do not have the hash it records");
}

// A start takes the stored estimates in place of all records before.
Result<void> Reexecution::check_snapshot(std::uint64_t number) {
  if (!snapshot_ || snapshot_->number != number) return {};
  const Result<EstimateSnapshot> stored = decode_snapshot(snapshot_->bytes);
  if (!stored) return {};  // of an older format, which a start does not read either
  const PoseGraph& map = head_.graph();
  double largest = stored->estimates.size() == map.nodes.size() ? 0.0 : 1.0;
  for (NodeIndex i = 0; i < map.nodes.size() && largest < 1.0; ++i)
    largest = std::max(largest, difference(stored->estimates[i], map.estimates[i]));
  if (largest > kTolerance) {
    return differs(
        number,
        "the estimates stored after it (snapshots/) are not those that the records give; "
        "move the folder snapshots away, a start does without");
  }
  result_.snapshot = number;
  return {};
}

Result<void> Reexecution::solve_again(const SolveRecord& record, std::uint64_t number) {
  const auto base = bases_.find(record.base);
  if (base == bases_.end())
    return differs(number,
                   "it solved record " + std::to_string(record.base) + ", which comes later");
  const std::optional<SolveMethod> method = SolveSettings::parse(record.settings).known();
  if (!method) {
    ++result_.solves_skipped;
    return {};
  }
  const MapSolution solution = solve_as(*method, base->second);
  const std::vector<VerdictRecord> verdicts = verdict_records(base->second, solution);
  if (--uses_of_base_[record.base] == 0) bases_.erase(base);
  if (!solution.usable()) return differs(number, "solved again, it does not converge");
  if (Result<void> same = judge_verdicts(record, verdicts, number); !same) return same;
  PoseGraph again = head_.graph();
  for (const auto& [node, estimate] : kept_changes(head_.graph(), solution, method->kind))
    again.estimates.edit(node) = estimate;
  PoseGraph recorded = head_.graph();
  for (const ChangedEstimate& changed : record.changed) {
    const auto node = head_.find(changed.node);
    if (!node) return differs(number, "there is no node " + to_string(changed.node));
    recorded.estimates.edit(*node) = to_estimate(changed.numbers);
  }
  return judge(record, again, recorded, number);
}

// The verdicts come right before the solve that has found them.
Result<void> Reexecution::judge_verdicts(const SolveRecord& record,
                                         const std::vector<VerdictRecord>& again,
                                         std::uint64_t number) const {
  const auto alike = [&](const VerdictRecord& a, const VerdictRecord& b) {
    if (a.factor != b.factor || a.state != b.state || a.test != b.test ||
        a.disagreeing != b.disagreeing)
      return false;
    const bool same_bits = a.value == b.value && a.threshold == b.threshold;
    const double largest = std::max({1.0, std::abs(a.value), std::abs(a.threshold)});
    return same_bits ||
           (rounds_otherwise(record) && std::abs(a.value - b.value) <= kTolerance * largest &&
            std::abs(a.threshold - b.threshold) <= kTolerance * largest);
  };
  if (std::equal(verdicts_.begin(), verdicts_.end(), again.begin(), again.end(), alike)) return {};
  return differs(number, "solved again, the gate finds " + std::to_string(again.size()) +
                             " verdicts, which are not the " + std::to_string(verdicts_.size()) +
                             " that are recorded before it");
}

Result<void> Reexecution::judge(const SolveRecord& record, const PoseGraph& again,
                                const PoseGraph& recorded, std::uint64_t number) {
  if (hash_estimates(again) == hash_estimates(recorded)) {
    ++result_.solves;
    return {};
  }
  NodeIndex worst = 0;
  double largest = -1.0;
  for (NodeIndex i = 0; i < again.nodes.size(); ++i) {
    const double apart = difference(again.estimates[i], recorded.estimates[i]);
    if (apart <= largest) continue;
    largest = apart;
    worst = i;
  }
  if (rounds_otherwise(record) && largest <= kTolerance) {
    ++result_.solves_compared;
    result_.largest_difference = std::max(result_.largest_difference, largest);
    if (!result_.other_settings) result_.other_settings = record.settings;
    return {};
  }
  char apart[32];
  std::snprintf(apart, sizeof apart, "%.3g", largest);
  return differs(number, "solved again, " + to_string(again.nodes[worst].id) + " differs by " +
                             apart + " (relative); recorded with \"" + record.settings +
                             "\", here is \"" + describe_platform() + '"');
}

}  // namespace cairn
