// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/history/question.hpp"

#include <algorithm>
#include <array>

#include "cairn/history/export.hpp"

namespace cairn {
namespace {

struct Verb {
  const char* name;
  Result<std::string> (*answer)(const Question&, const Asked&);
};
constexpr std::array kVerbs{Verb{"log", answer_log},
                            Verb{"show", answer_show},
                            Verb{"diff", answer_diff},
                            Verb{"keyframes", answer_keyframes},
                            Verb{"edge show", answer_edge_show},
                            Verb{"edge worst", answer_edge_worst},
                            Verb{"explain edge", answer_explain_edge},
                            Verb{"explain node", answer_explain_node},
                            Verb{"export graph", answer_export_graph},
                            Verb{"export trajectory", answer_export_trajectory},
                            Verb{"export map", answer_export_map}};

constexpr std::size_t kQuoted = 60;  // bytes of what somebody sent, in an error

}  // namespace

Result<Question> Question::parse(const std::string& text) {
  const std::size_t brace = text.find('{');
  Question question;
  question.verb = text.substr(0, brace);
  question.verb.erase(question.verb.find_last_not_of(' ') + 1);
  if (brace == std::string::npos) return question;
  question.options = nlohmann::ordered_json::parse(text.substr(brace), nullptr, false);
  if (question.options.is_object()) return question;
  return Error{ErrorCode::kUsage,
               "'" + text.substr(0, kQuoted) +
                   "' is no command; expected a verb and its options as a JSON object"};
}

Result<void> Question::check_options(std::initializer_list<const char*> known) const {
  for (const auto& [option, value] : options.items()) {
    if (std::find(known.begin(), known.end(), option) == known.end())
      return Error{ErrorCode::kUsage, verb + " has no option '" + option +
                                          "'; do client and daemon have the same version?"};
  }
  return {};
}

Result<void> Question::check_text() const {
  for (const auto& [option, value] : options.items()) {
    try {
      (void)value.dump();
    } catch (const nlohmann::json::type_error&) {
      return Error{ErrorCode::kUsage, "--" + option + " is not UTF-8; write it in UTF-8"};
    }
  }
  return {};
}

std::uint64_t Question::number(const char* option, std::uint64_t otherwise) const {
  const auto found = options.find(option);
  return found != options.end() && found->is_number_unsigned() ? found->get<std::uint64_t>()
                                                               : otherwise;
}

std::string Question::text(const char* option) const {
  const auto found = options.find(option);
  return found != options.end() && found->is_string() ? found->get<std::string>() : std::string();
}

bool Question::flag(const char* option) const {
  const auto found = options.find(option);
  return found != options.end() && found->is_boolean() && found->get<bool>();
}

Result<std::string> answer(const Question& question, const Asked& asked) {
  std::string known;
  for (const Verb& verb : kVerbs) {
    if (question.verb == verb.name) return verb.answer(question, asked);
    known += std::string(", ") + verb.name;
  }
  return Error{
      ErrorCode::kUsage,
      "unknown command '" + question.verb.substr(0, kQuoted) +
          "'; known: status, settle, backup, edge disable|enable|remove|trust|doubt, undo, revoke" +
          known};
}

Result<Record> find_record(const Journal& journal, std::uint64_t number) {
  const std::uint64_t newest = journal.head().revision.number;
  if (number > 0 && number <= newest) return journal.read(number);
  return Error{ErrorCode::kUsage, "there is no record " + std::to_string(number) +
                                      "; expected one of 1 to " + std::to_string(newest)};
}

std::string dump(const nlohmann::ordered_json& json, int indent) {
  return json.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace cairn
