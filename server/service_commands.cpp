// SPDX-License-Identifier: BSD-3-Clause
// What operators ask and order, one command after the other.
#include <algorithm>

#include "cairn/core/wall_clock.hpp"
#include "cairn/history/order.hpp"
#include "cairn/history/solve_record.hpp"
#include "server/service.hpp"
#include "server/status_json.hpp"

namespace cairn {
namespace {

constexpr std::size_t kMostAwaiting = 64;  // commands that wait for a solve

}  // namespace

void Service::carry_out(const Command& command) {
  const std::string verb = command.text.substr(0, command.text.find(' '));
  if (verb == "status") return transport_.reply({command.key, {}, dump(status_json(), -1)});
  const bool of_settled_map = verb == "settle" || verb == "freeze";
  if (of_settled_map && needs_solve()) {
    const bool repeated =
        std::any_of(awaiting_solution_.begin(), awaiting_solution_.end(),
                    [&](const Command& waiting) { return waiting.key == command.key; });
    if (repeated) return;
    if (awaiting_solution_.size() < kMostAwaiting) return awaiting_solution_.push_back(command);
    return transport_.reply({command.key, ErrorCode::kNotUsable,
                             "busy: " + std::to_string(kMostAwaiting) +
                                 " commands wait for a solve already; ask again later"});
  }
  if (const auto question = Question::parse(command.text); question && is_order(*question))
    return obey(command, *question);
  if (verb != "settle") return desk_.take(command, head_.graph());
  transport_.reply(
      {command.key, {}, settled_text(head_.graph().graph_revision, chi2_.value_or(0.0))});
}

// Durable before it is answered; asked again, it changes nothing more.
void Service::obey(const Command& command, const Question& question) {
  if (desk_.repeat(command.key)) return;
  const auto refuse = [&](const Error& error) {
    desk_.answer({command.key, error.code, error.to_string()});
  };
  const Result<Order> order = make_order(question, journal_, head_);
  if (!order) return refuse(order.error());
  if (order->changes_nothing()) return desk_.answer({command.key, {}, count_changes({})});
  const RecordBody record = to_record(*order, question, wall_clock_ns());
  pass(ServicePoint::kBeforeCommit);
  const Result<Revision> appended = journal_.append({&record, 1});
  pass(ServicePoint::kCommitted);
  if (!appended) {
    refuse(appended.error());
    return fall_back(appended.error());
  }
  apply(*order, *appended, head_);
  news_at_ = appended->number;
  state_changed_ = estimate_changed_ = true;
  const std::string done = count_changes(*order);
  announce(Severity::kInfo, "order", question.text("operator") + ": " + order->asked + ": " + done,
           *appended);
  desk_.answer({command.key, {}, done + ", record " + std::to_string(appended->number)});
}

}  // namespace cairn
