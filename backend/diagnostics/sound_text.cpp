// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/diagnostics/sound_text.hpp"

#include <algorithm>

namespace cairn {
namespace {

struct Edit {
  std::string_view part;
  std::string text;
};

// Takes the broken ids out of one FIX line, or the whole line where no other is left. `first` is
// the first id of the line; returns the first of the next line.
std::size_t blank_broken_fixes(const RawGraph& graph, std::size_t first, std::vector<Edit>& edits) {
  std::size_t end = first, sound = 0;
  for (; end < graph.fixes.size() && graph.fixes[end].line == graph.fixes[first].line; ++end) {
    sound += !graph.fixes[end].broken;
  }
  if (sound == 0) {
    edits.push_back({graph.fixes[first].text, ""});
    return end;
  }
  for (std::size_t f = first; f < end; ++f) {
    if (graph.fixes[f].broken) edits.push_back({graph.fixes[f].field.text, ""});
  }
  return end;
}

// Ones for the value (a range of zero would be refused), no rotation, unit information.
std::string neutral_line(const TagSpec& tag, std::span<const std::uint64_t> ids) {
  std::string text(tag.name);
  for (int v = 0; v < tag.variable_count; ++v)
    text += ' ' + std::to_string(ids[static_cast<std::size_t>(v)]);
  for (int p = 0; p < tag.parameter_count; ++p) {
    text += ' ' + std::to_string(static_cast<std::int64_t>(
                      ids[static_cast<std::size_t>(tag.variable_count + p)]));
  }
  for (int m = 0; m < tag.measurement; ++m) {
    const bool imaginary = tag.quaternion >= 0 && m >= tag.quaternion && m < tag.quaternion + 3;
    text += imaginary ? " 0" : " 1";
  }
  if (tag.information_optional) return text;
  for (int r = 0; r < tag.information; ++r) {
    for (int c = r; c < tag.information; ++c) text += r == c ? " 1" : " 0";
  }
  return text;
}

}  // namespace

const TagSpec* vertex_tag(GraphFormat format, VariableType type) {
  for (const TagSpec& tag : graph_tags(format)) {
    if (tag.role == TagRole::kVertex && tag.variables[0] == type) return &tag;
  }
  return nullptr;
}

std::string sound_text(const RawGraph& graph, const RawStructure& structure) {
  std::vector<Edit> edits;
  for (const std::string_view line : graph.rejected) edits.push_back({line, ""});
  for (std::size_t f = 0; f < graph.fixes.size();) f = blank_broken_fixes(graph, f, edits);
  for (const RawLine& line : graph.lines) {
    if (!line.broken) continue;
    edits.push_back({line.text, line.unusable ? std::string() : neutral_line(*line.tag, line.ids)});
  }
  std::sort(edits.begin(), edits.end(),
            [](const Edit& a, const Edit& b) { return a.part.data() < b.part.data(); });
  std::string result;
  result.reserve(graph.text.size());
  const char* done = graph.text.data();
  for (const Edit& edit : edits) {
    result.append(done, edit.part.data());
    result += edit.text;
    done = edit.part.data() + edit.part.size();
  }
  result.append(done, graph.text.data() + graph.text.size());
  for (const std::uint64_t id : structure.dangling) {
    const TagSpec* tag = vertex_tag(graph.format, structure.vertices.at(id).type);
    if (tag) result += '\n' + neutral_line(*tag, {&id, 1});
  }
  return result;
}

}  // namespace cairn
