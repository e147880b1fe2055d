// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "cairn/history/apply_record.hpp"

namespace cairn {

/// What is asked of a daemon or of its folder: a verb and its options. Travels as "VERB {JSON}".
struct Question {
  std::string verb;
  nlohmann::ordered_json options = nlohmann::ordered_json::object();

  /// kUsage where the text is none.
  static Result<Question> parse(const std::string& text);
  /// check_text() must have passed.
  [[nodiscard]] std::string to_string() const { return verb + ' ' + options.dump(); }
  /// What people typed must be UTF-8 to travel as JSON.
  [[nodiscard]] Result<void> check_text() const;

  /// An error names options that are not `known`.
  [[nodiscard]] Result<void> check_options(std::initializer_list<const char*> known) const;
  [[nodiscard]] std::uint64_t number(const char* option, std::uint64_t otherwise) const;
  [[nodiscard]] std::string text(const char* option) const;  ///< empty where it is absent
  [[nodiscard]] bool flag(const char* option) const;
};

/// Whom a question is about. All must outlive the answer.
struct Asked {
  const Journal& journal;
  std::function<Result<PoseGraph>()> map;  ///< at the head, or a little before
  KeepGoing keep_going{};
};

/// Answers log, show, diff, keyframes and export, for people or, with the option json, for
/// programs. kUsage where the question makes no sense.
Result<std::string> answer(const Question& question, const Asked& asked);

Result<std::string> answer_log(const Question& question, const Asked& asked);
Result<std::string> answer_show(const Question& question, const Asked& asked);
Result<std::string> answer_diff(const Question& question, const Asked& asked);
/// For programs alone: JSON with the poses from a place on ("from", in the order of their coming)
/// that have payloads, these in base64, until "most_bytes" are full, and those of "again" before
/// them. "next": where to go on; "waiting": places whose payloads have not come; "closed": up to
/// which place the loops of a "source" go.
Result<std::string> answer_keyframes(const Question& question, const Asked& asked);
Result<std::string> answer_edge_show(const Question& question, const Asked& asked);
Result<std::string> answer_edge_worst(const Question& question, const Asked& asked);
Result<std::string> answer_explain_edge(const Question& question, const Asked& asked);
Result<std::string> answer_explain_node(const Question& question, const Asked& asked);

/// A record that somebody asks for by its number. kUsage where there is none.
Result<Record> find_record(const Journal& journal, std::uint64_t number);

/// JSON on several lines, whatever bytes its texts hold.
std::string dump(const nlohmann::ordered_json& json, int indent = 2);

}  // namespace cairn
