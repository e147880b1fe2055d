// SPDX-License-Identifier: BSD-3-Clause
#include "clients/cli/fleet.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <unordered_map>

#include "cairn/io/graph_file.hpp"
#include "cairn/replay/graph_transactions.hpp"

namespace cairn::cli {
namespace {

constexpr std::size_t kLongestName = 64 - sizeof "replay-";  // the source is called so, too

std::uint64_t top_byte(VariableId id) { return id.value >> 56; }

Result<std::string> name_of(const std::string& file, const std::string& prefix) {
  std::filesystem::path path(file);
  if (!path.has_filename()) path = path.parent_path();  // a folder, with a slash at its end
  std::string name = path.filename().string();
  if (const auto dot = name.find('.'); dot != std::string::npos && dot > 0) name.resize(dot);
  name.insert(0, prefix);
  if (file == "-" || name.empty() || name.size() > kLongestName) {
    return Error{ErrorCode::kUsage,
                 "gives the robot no name of 1 to " + std::to_string(kLongestName) +
                     " bytes; give the file another name, or a shorter --prefix",
                 file};
  }
  return name;
}

// Whose vertices are whose, among files that name each other's.
class Owners {
 public:
  explicit Owners(const std::vector<GraphDocument>& documents) {
    for (std::size_t file = 0; file < documents.size(); ++file) {
      const auto variables = documents[file].graph.variables();
      std::map<std::uint64_t, std::size_t> bytes;
      for (std::size_t slot = 0; slot < variables.size(); ++slot) {
        const VariableId id = variables[slot].id;
        mentioned_[id].push_back(file);
        if (!documents[file].has_start[slot]) continue;
        declared_[id].push_back(file);
        ++bytes[top_byte(id)];
      }
      if (bytes.empty()) {
        for (const Variable& variable : variables) ++bytes[top_byte(variable.id)];
      }
      const auto most = std::max_element(bytes.begin(), bytes.end(),
                                         [](auto& a, auto& b) { return a.second < b.second; });
      home_.push_back(most == bytes.end() ? 0 : most->first);
    }
  }

  // Ids that carry their robot, or of which each stands in one file, mean the same everywhere.
  [[nodiscard]] bool ids_are_global() const {
    const bool keyed = std::all_of(mentioned_.begin(), mentioned_.end(),
                                   [](const auto& entry) { return top_byte(entry.first) != 0; });
    return keyed || (!declared_.empty() &&
                     std::all_of(declared_.begin(), declared_.end(),
                                 [](const auto& entry) { return entry.second.size() == 1; }));
  }

  [[nodiscard]] std::size_t owner(VariableId id) const {
    const auto declared = declared_.find(id);
    const std::vector<std::size_t>& files =
        declared == declared_.end() ? mentioned_.at(id) : declared->second;
    for (const std::size_t file : files) {
      if (home_[file] == top_byte(id)) return file;
    }
    return files.front();
  }

 private:
  std::unordered_map<VariableId, std::vector<std::size_t>> declared_, mentioned_;
  std::vector<std::uint64_t> home_;  ///< the top byte of most of a file's ids
};

void append(std::vector<std::string>& all, const std::vector<std::string>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

Result<Fleet> read_fleet(const std::vector<std::string>& files, const std::string& prefix) {
  Fleet fleet;
  std::vector<GraphDocument> documents;
  std::vector<std::string> names;
  for (const std::string& file : files) {
    const Result<std::string> name = name_of(file, prefix);
    if (!name) return name.error();
    if (std::find(names.begin(), names.end(), *name) != names.end())
      return Error{
          ErrorCode::kUsage,
          "a file before it gives the robot's name '" + *name + "', too; rename one of them", file};
    Result<GraphDocument> document = read_graph(file);
    if (!document) return document.error();
    documents.push_back(std::move(*document));
    names.push_back(*name);
    fleet.robots.push_back({*name, file, {}});
  }
  const Owners owners(documents);
  if (files.size() > 1 && owners.ids_are_global()) {
    const Result<GraphDocument> merged = read_graphs(files);
    if (!merged) return merged.error();
    append(fleet.warnings, merged->warnings);
    auto steps =
        fleet_transactions(merged->graph, names, [&](VariableId id) { return owners.owner(id); });
    for (std::size_t i = 0; i < steps.size(); ++i)
      fleet.robots[i].transactions = std::move(steps[i]);
    return fleet;
  }
  for (std::size_t i = 0; i < files.size(); ++i) {
    append(fleet.warnings, documents[i].warnings);
    fleet.robots[i].transactions = graph_transactions(documents[i].graph, [&](VariableId id) {
      return NodeId{{names[i], 0}, id.value};
    });
  }
  return fleet;
}

}  // namespace cairn::cli
