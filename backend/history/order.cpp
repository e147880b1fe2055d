// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/order.hpp"

#include <algorithm>
#include <array>
#include <ranges>
#include <set>

#include "cairn/factors/factor_codec.hpp"
#include "cairn/history/factor_text.hpp"
#include "cairn/history/record_json.hpp"

namespace cairn {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kChanges{"disable", "enable", "remove", "trust", "doubt"};
constexpr std::size_t kMostListed = 20;

std::optional<FactorChange> change_named(const std::string& word) {
  const auto found = std::find(kChanges.begin(), kChanges.end(), word);
  if (found == kChanges.end()) return std::nullopt;
  return static_cast<FactorChange>(found - kChanges.begin());
}

bool is_so(FactorState state, FactorChange change) {
  switch (change) {
    case FactorChange::kDisable:
      return state == FactorState::kDisabled;
    case FactorChange::kEnable:
      return is_enabled(state);
    case FactorChange::kTrust:
      return state == FactorState::kTrusted;
    case FactorChange::kDoubt:
      return state != FactorState::kTrusted;
    case FactorChange::kRemove:
      break;
  }
  return state == FactorState::kRemoved;
}

// Who asked, and why, stands in fields of its own.
std::string asked_by(Question question) {
  question.options.erase("operator");
  question.options.erase("reason");
  return question.verb + ' ' + dump(question.options, -1);
}

// Each of these can be undone one by one: what was trusted is trusted again.
void add_edits(const StoredFactor& factor, FactorChange change, std::vector<FactorEdit>& edits) {
  if (is_so(factor.state, change)) return;
  if (change == FactorChange::kTrust && !is_enabled(factor.state))
    edits.push_back({factor.name, FactorChange::kEnable});
  if (change == FactorChange::kDisable && factor.state == FactorState::kTrusted)
    edits.push_back({factor.name, FactorChange::kDoubt});
  edits.push_back({factor.name, change});
}

Result<Order> order_edges(const Question& question, const MapHead& head) {
  if (auto known = question.check_options({"factors", "operator", "reason"}); !known)
    return known.error();
  const FactorChange change = *change_named(question.verb.substr(question.verb.find(' ') + 1));
  const auto names = question.options.find("factors");
  if (names == question.options.end() || !names->is_array() || names->empty())
    return Error{ErrorCode::kUsage, question.verb + " expects the option factors: a list of names"};
  std::set<std::size_t> all;
  for (const Json& name : *names) {
    const auto places =
        factors_named(name.is_string() ? name.get<std::string>() : dump(name, -1), head.graph());
    if (!places) return places.error();
    all.insert(places->begin(), places->end());
  }
  Order order{asked_by(question), {}};
  for (const std::size_t place : all) {
    const StoredFactor& factor = head.graph().factors[place];
    if (change == FactorChange::kTrust && !is_gated(factor.type, factor.kind))
      return Error{ErrorCode::kUsage, "factor " + name_of(factor) +
                                          " is no loop closure between poses, so the gate decides "
                                          "nothing about it; name one (cairn edge show)"};
    add_edits(factor, change, order.edits);
  }
  if (const auto refusal = head.check(order.edits))
    return Error{ErrorCode::kNotUsable, refusal->reason + ": what was removed stays removed"};
  return order;
}

std::string list(const std::vector<std::uint64_t>& records) {
  std::string text;
  for (std::size_t i = 0; i < std::min(records.size(), kMostListed); ++i)
    text += (i == 0 ? "" : ", ") + std::to_string(records[i]);
  if (records.size() > kMostListed)
    text += " and " + std::to_string(records.size() - kMostListed) + " more";
  return text;
}

Result<std::vector<FactorEdit>> take_back(const std::set<std::uint64_t>& records, bool cascade,
                                          const std::string& who, const MapHead& head) {
  const MapHead::Consequences gone = head.consequences_of(records);
  if (gone.edited_by)
    return Error{ErrorCode::kNotUsable, "record " + std::to_string(*gone.edited_by) +
                                            " switches factors itself, which cannot be taken back "
                                            "with others; use cairn edge"};
  if (!gone.dependents.empty() && !cascade)
    return Error{ErrorCode::kNotUsable, "later records use variables that " + who +
                                            " added, and would have been refused without it: " +
                                            list(gone.dependents) + "; --cascade undoes them, too"};
  std::vector<FactorEdit> edits;
  for (const std::size_t place : gone.factors)
    add_edits(head.graph().factors[place], FactorChange::kDisable, edits);
  return edits;
}

// The first of a source's records that arrived then, or later.
Result<std::size_t> first_since(std::int64_t time_ns, std::span<const std::uint64_t> records,
                                const Journal& journal) {
  std::size_t first = 0, end = records.size();
  while (first < end) {
    const std::size_t middle = first + (end - first) / 2;
    const Result<Record> record = journal.read(records[middle]);
    if (!record) return record.error();
    if (time_of(*record).value_or(0) < time_ns)
      first = middle + 1;
    else
      end = middle;
  }
  return first;
}

Result<Order> order_revoke(const Question& question, const Journal& journal, const MapHead& head) {
  if (auto known = question.check_options({"source", "since", "cascade", "operator", "reason"});
      !known)
    return known.error();
  const std::string source = question.text("source"), since = question.text("since");
  const auto number = whole_number(since);
  const auto time_ns = from_utc(since);
  if (!number && !time_ns)
    return Error{ErrorCode::kUsage, "'" + since.substr(0, 60) +
                                        "' is no time; expected a record's number, or a UTC time "
                                        "as cairn log prints it: 2026-01-31T08:15:00.250Z"};
  const std::span<const std::uint64_t> sent = head.records_of(source);
  const Result<std::size_t> first =
      number ? static_cast<std::size_t>(std::ranges::lower_bound(sent, *number) - sent.begin())
             : first_since(*time_ns, sent, journal);
  if (!first) return first.error();
  if (*first == sent.size())
    return Error{ErrorCode::kUsage,
                 "nothing of source '" + source.substr(0, 64) + "' since " + since +
                     " is in the map" +
                     (sent.empty() ? "; cairn status lists sources"
                                   : "; its last record is " + std::to_string(sent.back()))};
  auto edits = take_back({sent.begin() + static_cast<std::ptrdiff_t>(*first), sent.end()},
                         question.flag("cascade"), "source '" + source + "'", head);
  if (!edits) return edits.error();
  return Order{asked_by(question), std::move(*edits)};
}

Result<std::vector<FactorEdit>> undo_order(std::uint64_t number, const Order& order,
                                           const MapHead& head) {
  using enum FactorChange;
  constexpr std::array kOpposites{kEnable, kDisable, kRemove, kDoubt, kTrust};
  std::vector<FactorEdit> edits;
  for (auto edit = order.edits.rbegin(); edit != order.edits.rend(); ++edit) {
    if (edit->change == kRemove)
      return Error{ErrorCode::kNotUsable, "record " + std::to_string(number) +
                                              " removed factors for good; disable keeps them"};
    edits.push_back({edit->factor, kOpposites[static_cast<std::size_t>(edit->change)]});
  }
  std::erase_if(edits, [&](const FactorEdit& edit) {
    const auto place = head.find(edit.factor);
    return place && is_so(head.graph().factors[*place].state, edit.change);
  });
  if (const auto refusal = head.check(edits))
    return Error{ErrorCode::kNotUsable, refusal->reason + ": it was removed since"};
  return edits;
}

// Everything that leads to the nodes goes; that the factors of record `by` come with it is said so
// that undo knows.
Result<Order> order_thinned(const Question& question, const MapHead& head) {
  if (auto known = question.check_options({"nodes", "by", "operator", "reason"}); !known)
    return known.error();
  const auto named = question.options.find("nodes");
  const std::size_t count = head.graph().nodes.size();
  const auto is_node = [&](const Json& number) {
    return number.is_number_unsigned() && number.get<std::uint64_t>() < count;
  };
  if (named == question.options.end() || !named->is_array() ||
      !std::all_of(named->begin(), named->end(), is_node))
    return Error{ErrorCode::kUsage, "thin expects the option nodes: numbers below " +
                                        std::to_string(count) + ", in order of arrival"};
  std::set<NodeIndex> gone;
  for (const Json& number : *named) gone.insert(number.get<NodeIndex>());
  const std::uint64_t by = question.number("by", 0);
  Order order{asked_by(question)};
  const auto& factors = head.graph().factors;
  for (std::size_t f = 0; f < factors.size(); ++f) {
    const bool made = factors[f].record == by;
    const bool leads_there = std::any_of(factors[f].nodes.begin(), factors[f].nodes.end(),
                                         [&](NodeIndex node) { return gone.contains(node); });
    if (made || (leads_there && is_enabled(factors[f].state)))
      order.edits.push_back(
          {factors[f].name, made ? FactorChange::kEnable : FactorChange::kDisable});
  }
  return order;
}

Result<Order> freeze_first(NodeIndex nodes, std::string asked, const MapHead& head) {
  const NodeIndex before = head.graph().frozen_nodes;
  if (nodes == before) return Order{std::move(asked)};
  if (nodes > 0 && head.graph().solved_revision.number < head.last_input())
    return Error{ErrorCode::kNotUsable,
                 "the newest input is not solved yet, and a map is frozen as it was solved: run "
                 "cairn settle first"};
  Order order{std::move(asked)};
  order.frozen = {before, nodes};
  return order;
}

Result<Order> order_frozen(const Question& question, const MapHead& head) {
  if (auto known = question.check_options({"operator", "reason"}); !known) return known.error();
  const auto all = static_cast<NodeIndex>(head.graph().nodes.size());
  return freeze_first(question.verb == "freeze" ? all : 0, asked_by(question), head);
}

Result<Order> order_undo(const Question& question, const Journal& journal, const MapHead& head) {
  if (auto known = question.check_options({"record", "cascade", "operator", "reason"}); !known)
    return known.error();
  const std::uint64_t number = question.number("record", 0);
  const Result<Record> record = find_record(journal, number);
  if (!record) return record.error();
  Result<std::vector<FactorEdit>> edits = Error{
      ErrorCode::kUsage, "record " + std::to_string(number) +
                             " changed nothing that could be undone: only transactions that were "
                             "accepted and operators' orders can"};
  if (const auto* command = std::get_if<CommandRecord>(&record->body)) {
    const auto order = order_of(*command);
    if (!order) return order.error();
    if (*order && (*order)->frozen)
      return freeze_first((*order)->frozen->before, asked_by(question), head);
    if (*order) edits = undo_order(number, **order, head);
  } else if (const auto* sent = std::get_if<TransactionRecord>(&record->body)) {
    if (std::holds_alternative<Transaction>(sent->outcome))
      edits =
          take_back({number}, question.flag("cascade"), "record " + std::to_string(number), head);
  }
  if (!edits) return edits.error();
  return Order{asked_by(question), std::move(*edits)};
}

Json to_json(const FactorEdit& edit) {
  const TransactionKey& key = edit.factor.transaction;
  return {key.source, key.epoch, key.sequence, edit.factor.index,
          kChanges[static_cast<std::size_t>(edit.change)]};
}

std::optional<FactorEdit> edit_of(const Json& json) {
  if (!json.is_array() || json.size() != 5 || !json[0].is_string() || !json[4].is_string() ||
      !std::all_of(json.begin() + 1, json.begin() + 4,
                   [](const Json& number) { return number.is_number_unsigned(); }))
    return std::nullopt;
  const auto change = change_named(json[4].get<std::string>());
  if (!change || json[3].get<std::uint64_t>() > ~std::uint32_t{0}) return std::nullopt;
  const TransactionKey key{json[0].get<std::string>(), json[1].get<std::uint64_t>(),
                           json[2].get<std::uint64_t>()};
  return FactorEdit{{key, json[3].get<std::uint32_t>()}, *change};
}

std::optional<Order::Frozen> frozen_of(const Json& json) {
  constexpr std::uint64_t kMost = ~NodeIndex{0};
  const auto is_count = [](const Json& number) {
    return number.is_number_unsigned() && number.get<std::uint64_t>() <= kMost;
  };
  if (!json.is_array() || json.size() != 2 || !is_count(json[0]) || !is_count(json[1]))
    return std::nullopt;
  return Order::Frozen{json[0].get<NodeIndex>(), json[1].get<NodeIndex>()};
}

}  // namespace

bool is_order(const Question& question) {
  for (const char* verb : {"undo", "revoke", "freeze", "thaw", "thin"})
    if (question.verb == verb) return true;
  return question.verb.starts_with("edge ") && change_named(question.verb.substr(5));
}

Result<Order> make_order(const Question& question, const Journal& journal, const MapHead& head) {
  Result<Order> order = [&]() -> Result<Order> {
    if (question.verb == "undo") return order_undo(question, journal, head);
    if (question.verb == "revoke") return order_revoke(question, journal, head);
    if (question.verb.starts_with("edge ")) return order_edges(question, head);
    if (question.verb == "thin") return order_thinned(question, head);
    return order_frozen(question, head);
  }();
  if (!order) return order;
  // A journal with an order that cannot be applied again would never be opened again.
  if (const auto refusal = head.check(order->edits))
    return Error{ErrorCode::kNotUsable, refusal->reason};
  // Names are bytes, JSON is UTF-8.
  const auto kept = order_of(to_record(*order, question, 0));
  const auto same = [](const FactorEdit& a, const FactorEdit& b) {
    return a.factor == b.factor && a.change == b.change;
  };
  if (!kept || !*kept || !std::ranges::equal((*kept)->edits, order->edits, same))
    return Error{ErrorCode::kNotUsable,
                 "a source's name is not UTF-8: its factors cannot be named in a journal"};
  return order;
}

CommandRecord to_record(const Order& order, const Question& question, std::int64_t time_ns) {
  Json edits = Json::array();
  for (const FactorEdit& edit : order.edits) edits.push_back(to_json(edit));
  Json json{{"asked", order.asked}, {"edits", std::move(edits)}};
  if (order.frozen) json["frozen"] = {order.frozen->before, order.frozen->after};
  return {question.text("operator"), question.text("reason"), dump(json, -1), time_ns};
}

Result<std::optional<Order>> order_of(const CommandRecord& record) {
  const Json whole = Json::parse(record.command, nullptr, false);
  if (!whole.is_object()) return std::optional<Order>();
  const Error broken{ErrorCode::kBadInput, "the order '" + record.command.substr(0, 60) +
                                               "' holds changes that this Cairn cannot read"};
  const auto asked = whole.find("asked"), edits = whole.find("edits");
  if (asked == whole.end() || !asked->is_string() || edits == whole.end() || !edits->is_array())
    return broken;
  Order order{asked->get<std::string>()};
  if (const auto frozen = whole.find("frozen"); frozen != whole.end()) {
    order.frozen = frozen_of(*frozen);
    if (!order.frozen) return broken;
  }
  for (const Json& json : *edits) {
    auto edit = edit_of(json);
    if (!edit) return broken;
    order.edits.push_back(std::move(*edit));
  }
  return std::optional(std::move(order));
}

void apply(const Order& order, const Revision& revision, MapHead& head) {
  if (order.frozen)
    head.freeze(order.frozen->after, revision);
  else
    head.apply(order.edits, revision);
}

std::string count_changes(const Order& order) {
  if (order.frozen)
    return order.frozen->after == 0 ? "all nodes may move again"
                                    : std::to_string(order.frozen->after) + " nodes frozen";
  constexpr std::array kDone{" disabled", " enabled", " removed", " trusted", " doubted"};
  std::array<std::size_t, kDone.size()> counts{};
  for (const FactorEdit& edit : order.edits) ++counts[static_cast<std::size_t>(edit.change)];
  std::string text;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    text += (text.empty() ? "" : ", ") + std::to_string(counts[i]) +
            (!text.empty()    ? ""
             : counts[i] == 1 ? " factor"
                              : " factors") +
            kDone[i];
  }
  return text.empty() ? "nothing changed: it is so already" : text;
}

}  // namespace cairn
