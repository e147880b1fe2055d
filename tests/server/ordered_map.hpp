// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "cairn/factors/factor_codec.hpp"
#include "cairn/history/order.hpp"
#include "cairn/history/solve_record.hpp"
#include "cairn/replay/settle.hpp"
#include "tests/server/drive.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn::test {

using Json = nlohmann::ordered_json;

/// A journal and the map that it leads to.
class OrderedMap {
 public:
  /// The number of its record.
  std::uint64_t take(Transaction transaction, const std::string& source = "laser",
                     std::int64_t time_ns = 0) {
    transaction.key = {source, 7, ++sequences_[source]};
    EXPECT_FALSE(head_.check(transaction)) << head_.check(transaction)->reason;
    const auto revision =
        append(TransactionRecord{transaction, content_hash(encode(transaction)), time_ns});
    head_.apply(transaction, revision);
    return revision.number;
  }
  std::uint64_t take_all(const std::vector<Transaction>& transactions,
                         const std::string& source = "laser") {
    std::uint64_t last = 0;
    for (const Transaction& transaction : transactions) last = take(transaction, source);
    return last;
  }
  Result<Order> ask(const std::string& verb, Json options) {
    return make_order({verb, std::move(options)}, *journal_, head_);
  }
  /// The record of the order; 0 where it is refused.
  std::uint64_t give(const std::string& verb, Json options) {
    options["operator"] = "anna";
    options["reason"] = "it was a mirror => really {\"edits\":[]}";
    const Question question{verb, std::move(options)};
    const auto order = make_order(question, *journal_, head_);
    EXPECT_TRUE(order) << order.error().to_string();
    if (!order) return 0;
    const auto revision = append(to_record(*order, question, 5));
    apply(*order, revision, head_);
    return revision.number;
  }
  std::uint64_t undo(std::uint64_t record, bool cascade = false) {
    return give("undo", {{"record", record}, {"cascade", cascade}});
  }
  [[nodiscard]] FactorState state(std::size_t place) const {
    return head_.graph().factors[place].state;
  }
  [[nodiscard]] std::vector<double> settled() const { return settled(head_.graph()); }
  /// The same from the journal alone.
  [[nodiscard]] std::vector<double> settled_after_restart() const {
    const auto maps = maps_at(*journal_, {journal_->head().revision.number});
    EXPECT_TRUE(maps) << maps.error().to_string();
    return settled(maps->front());
  }
  /// A solve of the map as it stands.
  void solve(SolveKind kind = SolveKind::kSettled) {
    const PoseGraph base = head_.graph();
    Revision next = base.graph_revision;
    ++next.number;
    const MapSolution solution = solve_as({kind}, base);
    EXPECT_TRUE(solution.usable());
    EXPECT_TRUE(
        journal_->append(apply_solution(head_, base.graph_revision, solution, next, {kind})));
  }
  [[nodiscard]] const PoseGraph& graph() const { return head_.graph(); }
  [[nodiscard]] const Journal& journal() const { return *journal_; }

 private:
  Revision append(RecordBody body) { return *journal_->append({&body, 1}); }
  static std::vector<double> settled(const PoseGraph& map) {
    const SettledEstimate estimate = settle(map);
    EXPECT_TRUE(estimate.summary.usable());
    std::vector<double> all{estimate.summary.final_chi2};
    for (std::uint32_t place = 0; place < estimate.order.nodes.size(); ++place)
      for (const double number : describe_value(estimate.graph, place)) all.push_back(number);
    return all;
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<Journal> journal_ = *Journal::open(folder_.file("data"));
  MapHead head_;
  std::map<std::string, std::uint64_t> sequences_;
};

/// So uncertain that no gate minds.
inline Transaction uncertain_false_loop(std::uint64_t a, std::uint64_t b) {
  Transaction transaction = false_loop(a, b);
  const std::span<double> information = std::span(transaction.factors[0].numbers).subspan(3);
  for (double& number : information) number *= 1e-4;
  return transaction;
}

}  // namespace cairn::test
