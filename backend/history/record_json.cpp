// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/record_json.hpp"

#include <cctype>
#include <cstdio>
#include <ctime>
#include <map>

#include "cairn/factors/factor_codec.hpp"
#include "cairn/history/order.hpp"

namespace cairn {
namespace {

using Json = nlohmann::ordered_json;

std::string name_of(FactorType type) {
  const FactorTypeInfo* info = find_factor_type(type);
  return info != nullptr ? std::string(info->name) : std::to_string(static_cast<int>(type));
}

Json json_of(const TransactionKey& key) {
  return {{"source", key.source}, {"epoch", key.epoch}, {"sequence", key.sequence}};
}

Json json_of(const NewVariable& variable) {
  Json json{{"node", to_string(variable.node)},
            {"type", to_string(variable.type)},
            {"start", variable.start},
            {"stamp_ns", variable.stamp_ns}};
  if (!variable.odometry.empty()) json["odometry"] = variable.odometry;
  return json;
}

Json json_of(const NewFactor& factor) {
  Json json{{"type", name_of(factor.type)}, {"kind", to_string(factor.kind)}};
  for (const NodeId& node : factor.nodes) json["nodes"].push_back(to_string(node));
  json["numbers"] = factor.numbers;
  for (const ContentHash& payload : factor.payloads) json["payloads"].push_back(to_string(payload));
  return json;
}

void add_edits(Json& json, const std::vector<FactorEdit>& edits) {
  constexpr const char* kWords[] = {"disable", "enable", "remove", "trust", "doubt"};
  json["edits"] = Json::array();
  for (const FactorEdit& edit : edits)
    json["edits"].push_back(
        {{"factor", to_string(edit.factor)}, {"change", kWords[static_cast<int>(edit.change)]}});
}

// "edge disable 12:0 14", as an operator would type it.
std::string name_of(const Order& order) {
  const Result<Question> question = Question::parse(order.asked);
  if (!question) return order.asked;
  std::string text = question->verb;
  if (const auto record = question->options.find("record"); record != question->options.end())
    text += ' ' + dump(*record, -1);
  for (const char* option : {"source", "since"})
    if (const std::string value = question->text(option); !value.empty())
      text += std::string(" --") + option + ' ' + value;
  if (question->flag("cascade")) text += " --cascade";
  if (const auto factors = question->options.find("factors"); factors != question->options.end())
    for (const Json& factor : *factors)
      text += ' ' + (factor.is_string() ? factor.get<std::string>() : dump(factor, -1));
  return text;
}

void add(Json& json, const Transaction& transaction) {
  json["sent"] = to_utc(transaction.sent_ns);
  json["variables"] = Json::array();
  for (const NewVariable& variable : transaction.variables)
    json["variables"].push_back(json_of(variable));
  json["factors"] = Json::array();
  for (const NewFactor& factor : transaction.factors) json["factors"].push_back(json_of(factor));
  if (!transaction.edits.empty()) add_edits(json, transaction.edits);
}

void add(Json& json, const TransactionRecord& record) {
  json["key"] = json_of(record.key());
  json["content_hash"] = to_string(record.content_hash);
  if (const auto* refused = std::get_if<RefusedTransaction>(&record.outcome)) {
    json["refusal"] = to_string(refused->code);
    json["reason"] = refused->reason;
  } else {
    add(json, std::get<Transaction>(record.outcome));
  }
}

void add(Json& json, const CommandRecord& record) {
  json["operator"] = record.operator_name;
  json["reason"] = record.reason;
  const auto order = order_of(record);
  if (!order || !*order) {
    json["command"] = record.command;
    return;
  }
  json["command"] = (*order)->asked;
  add_edits(json, (*order)->edits);
}

void add(Json& json, const VerdictRecord& record) {
  json["factor"] = to_string(record.factor);
  json["test"] = record.test;
  json["value"] = record.value;
  json["threshold"] = record.threshold;
  for (const FactorName& factor : record.disagreeing)
    json["disagreeing"].push_back(to_string(factor));
  json["state"] = to_string(record.state);
}

void add(Json& json, const SolveRecord& record) {
  json["base"] = record.base;
  json["settings"] = record.settings;
  json["start"] = record.start;
  json["work_limit"] = record.work_limit;
  json["estimates_hash"] = to_string(record.estimates_hash);
  json["changed"] = Json::array();
  for (const ChangedEstimate& changed : record.changed)
    json["changed"].push_back({{"node", to_string(changed.node)}, {"estimate", changed.numbers}});
}

std::string summary(const TransactionRecord& record) {
  if (const auto* refused = std::get_if<RefusedTransaction>(&record.outcome))
    return std::string(to_string(refused->code)) + ": " + refused->reason;
  const auto& transaction = std::get<Transaction>(record.outcome);
  std::string text;
  const auto count = [&](const std::map<std::string, std::size_t>& counts) {
    for (const auto& [name, number] : counts)
      text += (text.empty() ? "+" : ", +") + std::to_string(number) + ' ' + name;
  };
  std::map<std::string, std::size_t> variables, factors;
  for (const NewVariable& variable : transaction.variables)
    ++variables[std::string(to_string(variable.type))];
  for (const NewFactor& factor : transaction.factors)
    ++factors[name_of(factor.type) + (factor.kind == FactorKind::kLoop ? " (loop)" : "")];
  count(variables);
  if (!transaction.variables.empty())
    text += " (" + to_string(transaction.variables.front().node) +
            (transaction.variables.size() > 1 ? ", ...)" : ")");
  count(factors);
  if (!transaction.edits.empty())
    text += (text.empty() ? "" : ", ") + std::to_string(transaction.edits.size()) + " edits";
  return text.empty() ? "nothing" : text;
}

std::string summary(const CommandRecord& record) {
  const auto order = order_of(record);
  const std::string what =
      order && *order ? name_of(**order) + ": " + count_changes(**order) : record.command;
  return record.operator_name + ": " + what +
         (record.reason.empty() ? "" : " (" + record.reason + ')');
}

std::string summary(const VerdictRecord& record) {
  char numbers[64];
  std::snprintf(numbers, sizeof numbers, "%.6g (limit %.6g)", record.value, record.threshold);
  return to_string(record.factor) + " is " + std::string(to_string(record.state)) + ": " +
         record.test + ' ' + numbers;
}

std::string summary(const SolveRecord& record) {
  return "of record " + std::to_string(record.base) + ": " + std::to_string(record.changed.size()) +
         " estimates changed";
}

}  // namespace

std::string_view to_string(FactorState state) {
  constexpr std::string_view kWords[] = {"pending",  "committed", "quarantined",
                                         "disabled", "removed",   "trusted"};
  return kWords[static_cast<int>(state)];
}

std::string_view to_string(FactorKind kind) {
  constexpr std::string_view kWords[] = {"odometry", "loop", "other"};
  return kWords[static_cast<int>(kind)];
}

std::string to_string(const FactorName& factor) {
  return factor.transaction.source + '/' + std::to_string(factor.transaction.sequence) + '#' +
         std::to_string(factor.index);
}

std::string to_utc(std::int64_t time_ns) {
  std::int64_t seconds = time_ns / 1'000'000'000, rest_ns = time_ns % 1'000'000'000;
  if (rest_ns < 0) --seconds, rest_ns += 1'000'000'000;
  const auto time = static_cast<std::time_t>(seconds);
  std::tm utc{};
  gmtime_r(&time, &utc);
  char date[40], text[64];
  std::strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%S", &utc);
  std::snprintf(text, sizeof text, "%s.%03dZ", date, static_cast<int>(rest_ns / 1'000'000));
  return text;
}

std::optional<std::int64_t> from_utc(const std::string& text) {
  constexpr std::size_t kSeconds = 19;  // bytes of the date and the time
  std::tm utc{};
  const char* rest = strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S", &utc);
  if (rest != text.c_str() + kSeconds) return std::nullopt;
  if (utc.tm_year < 70 || utc.tm_year > 200) return std::nullopt;  // int64 ns end in 2262
  const std::tm read = utc;
  std::int64_t time_ns = std::int64_t{timegm(&utc)} * 1'000'000'000;
  if (utc.tm_mday != read.tm_mday || utc.tm_sec != read.tm_sec) return std::nullopt;  // no such day
  if (*rest == '.') {
    std::int64_t unit_ns = 100'000'000;
    for (++rest; std::isdigit(static_cast<unsigned char>(*rest)) != 0; ++rest, unit_ns /= 10)
      time_ns += (*rest - '0') * unit_ns;
  }
  if (rest[0] != 'Z' || rest + 1 != text.c_str() + text.size()) return std::nullopt;
  return time_ns;
}

std::string kind_of(const Record& record) {
  constexpr const char* kWords[] = {"", "transaction", "command", "verdict", "solve"};
  const auto* transaction = std::get_if<TransactionRecord>(&record.body);
  if (transaction != nullptr && std::holds_alternative<RefusedTransaction>(transaction->outcome))
    return "refusal";
  return kWords[static_cast<int>(record.kind())];
}

const TransactionKey* key_of(const Record& record) {
  const auto* transaction = std::get_if<TransactionRecord>(&record.body);
  return transaction == nullptr ? nullptr : &transaction->key();
}

std::optional<std::int64_t> time_of(const Record& record) {
  if (const auto* transaction = std::get_if<TransactionRecord>(&record.body))
    return transaction->arrival_ns;
  if (const auto* command = std::get_if<CommandRecord>(&record.body)) return command->arrival_ns;
  return std::nullopt;
}

nlohmann::ordered_json to_json(const Record& record) {
  Json json{{"number", record.number}, {"era", record.era}, {"kind", kind_of(record)}};
  if (const auto time = time_of(record)) json["time"] = to_utc(*time);
  std::visit([&](const auto& body) { add(json, body); }, record.body);
  json["chain_hash"] = to_string(record.chain);
  return json;
}

std::string summarize(const Record& record) {
  return std::visit([](const auto& body) { return summary(body); }, record.body);
}

}  // namespace cairn
