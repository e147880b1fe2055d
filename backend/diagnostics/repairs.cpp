// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/repairs.hpp"

#include <algorithm>

namespace cairn {

void Repairs::replace(CheckCode code, std::size_t line, const std::vector<Replacement>& parts,
                      std::string what) {
  if (!lines_.insert(line).second) return;
  for (const Replacement& replacement : parts) {
    edits_.push_back({static_cast<std::size_t>(replacement.part.data() - text_.data()),
                      replacement.part.size(), replacement.text});
  }
  changes_.push_back({code, line, std::move(what)});
}

void Repairs::drop(CheckCode code, std::size_t line, std::string_view line_text, std::string what) {
  if (!lines_.insert(line).second) return;
  edits_.push_back({static_cast<std::size_t>(line_text.data() - text_.data()), 0,
                    "# " + to_string(code) + " dropped: "});
  changes_.push_back({code, line, std::move(what)});
}

void Repairs::append(CheckCode code, std::string line_text, std::string what) {
  appended_.push_back(std::move(line_text));
  changes_.push_back({code, 0, std::move(what)});
}

std::string Repairs::apply() const {
  std::vector<Edit> edits = edits_;
  std::stable_sort(edits.begin(), edits.end(),
                   [](const Edit& a, const Edit& b) { return a.offset < b.offset; });
  std::string result;
  result.reserve(text_.size() + text_.size() / 16);
  std::size_t done = 0;
  for (const Edit& edit : edits) {
    result.append(text_.substr(done, edit.offset - done)).append(edit.text);
    done = edit.offset + edit.length;
  }
  result.append(text_.substr(done));
  for (const std::string& line : appended_) {
    if (!result.empty() && result.back() != '\n') result += '\n';
    result.append(line) += '\n';
  }
  return result;
}

}  // namespace cairn
