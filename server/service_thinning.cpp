// SPDX-License-Identifier: BSD-3-Clause
// Old poses of revisited places are marginalized out while nothing else is to be done.
#include <cstdio>
#include <numbers>

#include "cairn/core/wall_clock.hpp"
#include "cairn/history/order.hpp"
#include "server/replay_journal.hpp"
#include "server/service.hpp"

namespace cairn {
namespace {

constexpr std::uint64_t kOwnEpoch = 1;

}  // namespace

void Service::thin_when_due() {
  if (options_.thin_after_visits == 0 || !settled_ || needs_solve() ||
      thinned_at_ == head_.last_input())
    return;
  ThinningOptions how{.visits = options_.thin_after_visits,
                      .radius_m = 0.01 * options_.thin_radius_cm,
                      .angle_rad = options_.thin_angle_deg * std::numbers::pi / 180.0};
  on_solver_thread(
      [how, map = head_.graph(), input = head_.last_input()]() -> std::optional<Message> {
        return Thinned{input, plan_thinning(map, kOwnSource, how)};
      });
}

// What takes the poses' place comes as a transaction of the daemon's own; then an order switches
// off what led to them. Undoing the order brings them back.
void Service::take_out(const Thinned& thinned) {
  if (thinned.last_input != head_.last_input() || solving_) return;  // planned again later
  if (thinned.plan.nodes.empty()) {
    thinned_at_ = thinned.last_input;
    return;
  }
  Transaction transaction;
  transaction.key = {kOwnSource, kOwnEpoch, sequencer_.highest_decided(kOwnSource, kOwnEpoch) + 1};
  transaction.factors = thinned.plan.factors;
  Sequencer::Outcome outcome;
  sequencer_.take(make_arrival(std::move(transaction)), turn(outcome));
  Revision made = journal_.head().revision;
  ++made.number;
  char lost[32];
  std::snprintf(lost, sizeof lost, "%.3g", thinned.plan.information_lost);
  const Question question{
      "thin",
      {{"nodes", thinned.plan.nodes},
       {"by", made.number},
       {"operator", "cairnd"},
       {"reason", std::to_string(thinned.plan.nodes.size()) + " poses of revisited places, " +
                      lost + " nats of information lost"}}};
  const Result<Order> order = make_order(question, journal_, head_);
  if (outcome.decisions.size() != 1 || outcome.decisions.front().refusal || !order) {
    thinned_at_ = thinned.last_input;
    return fall_back(order ? Error{ErrorCode::kInternal, "a thinning of the map was refused"}
                           : order.error());
  }
  const std::int64_t now = wall_clock_ns();
  const std::vector<RecordBody> records{record_of(std::move(outcome.decisions.front()), now),
                                        to_record(*order, question, now)};
  pass(ServicePoint::kBeforeCommit);
  const Result<Revision> appended = journal_.append(records);
  pass(ServicePoint::kCommitted);
  if (!appended) return fall_back(appended.error());
  apply(*order, *appended, head_);
  news_at_ = appended->number;
  state_changed_ = estimate_changed_ = true;
  announce(Severity::kInfo, "thinned", question.text("reason"), *appended);
}

}  // namespace cairn
