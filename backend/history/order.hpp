// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cairn/history/question.hpp"

namespace cairn {

/// What an operator changes by hand: factors that are switched off, on, or removed for good, loop
/// closures that are trusted or left to the gate. Kept
/// as a command record, so that it can be told, done again by `cairn verify`, and undone.
struct Order {
  std::string asked;                ///< "edge disable {...}": the question it was
  std::vector<FactorEdit> edits{};  ///< only of factors that are not so already
  struct Frozen {
    NodeIndex before = 0, after = 0;  ///< PoseGraph::frozen_nodes
  };
  std::optional<Frozen> frozen{};  ///< where it freezes or thaws the map

  [[nodiscard]] bool changes_nothing() const { return edits.empty() && !frozen; }
};

/// Works out what a question orders, on the map at the journal's head:
/// `edge disable|enable|remove {"factors": ["12:0", "14"]}` by record and place (all of a record's
/// without one), `edge trust|doubt` likewise; `undo {"record": 12, "cascade": false}`: the map as
/// if a transaction had never come, or an order had never been given; `revoke {"source": S,
/// "since": T, "cascade": false}`: as if nothing had come of a source since a record's number, or a
/// UTC time, as text; `freeze`: every node stays where it is, of a map that is solved, and `thaw`:
/// all may move again; `thin {"nodes": [3, 4], "by": 12}`: factors that lead to these nodes (by
/// order of arrival) are switched off, in favor of those of record 12. kUsage where it makes no
/// sense, kNotUsable where later records stand in the way; the message lists them.
Result<Order> make_order(const Question& question, const Journal& journal, const MapHead& head);
/// Whether make_order() is whom to ask.
bool is_order(const Question& question);

CommandRecord to_record(const Order& order, const Question& question, std::int64_t time_ns);
/// Nothing where the record is a note that orders nothing.
Result<std::optional<Order>> order_of(const CommandRecord& record);

/// Does what it orders.
void apply(const Order& order, const Revision& revision, MapHead& head);
/// "2 factors disabled, 1 enabled", "812 nodes frozen", for people.
std::string count_changes(const Order& order);

}  // namespace cairn
