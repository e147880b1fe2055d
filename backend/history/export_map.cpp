// SPDX-License-Identifier: BSD-3-Clause
// What the scans of a map's nodes make of the ground.
#include <set>

#include "cairn/graph/ground_pose.hpp"
#include "cairn/history/export.hpp"
#include "cairn/history/export_content.hpp"
#include "cairn/history/map_text.hpp"
#include "cairn/maps/map_renderer.hpp"

namespace cairn {
namespace {

constexpr double kLeastCell = 0.01, kLargestCell = 10.0;  // m
constexpr std::size_t kMostTiles = 32'768;                // 1 GB

// The scans of the chosen robots' poses, in canonical order.
struct ScansOfMap {
  std::vector<ContentHash> payloads;  ///< by ScanId
  std::vector<PlacedScan> placed;
};

Result<ScansOfMap> find_scans(const ExportContent& content, const std::string& wanted) {
  ScansOfMap found;
  std::set<std::string> robots;
  for (std::size_t place = 0; place < content.values.size(); ++place) {
    const StoredNode& node = content.node_at(place);
    if (!is_pose(node.type)) continue;
    robots.insert(node.id.frame.robot);
    if (!wanted.empty() && node.id.frame.robot != wanted) continue;
    for (const ContentHash& payload : node.payloads) {
      found.placed.push_back({found.payloads.size(), ground_pose(content.values[place])});
      found.payloads.push_back(payload);
    }
  }
  if (wanted.empty() || robots.contains(wanted)) return found;
  std::string known;
  for (const std::string& robot : robots) known += (known.empty() ? "" : ", ") + robot;
  return no_such_robot(wanted, known);
}

// Reads scans from the journal, and counts what it finds.
class ScanReader {
 public:
  ScanReader(const Journal& journal, const std::vector<ContentHash>& payloads)
      : journal_(journal), payloads_(payloads) {}

  std::shared_ptr<const RangeScan> operator()(ScanId id) {
    const Result<std::string> bytes = journal_.read_payload(payloads_[id]);
    if (!bytes) {
      ++missing;
      return nullptr;
    }
    Result<RangeScan> scan = decode_range_scan(*bytes);
    if (!scan) return nullptr;  // an image, say
    ++scans;
    return std::make_shared<RangeScan>(std::move(*scan));
  }

  std::size_t scans = 0, missing = 0;

 private:
  const Journal& journal_;
  const std::vector<ContentHash>& payloads_;
};

struct RenderedMap {
  MapImage image;
  std::size_t scans, missing;
};

Result<RenderedMap> render(const ScansOfMap& scans, double resolution_m, MapModel model,
                           const Asked& asked) {
  LaserMap map(resolution_m);
  ScanReader reader(asked.journal, scans.payloads);
  const auto fits = [&] { return map.grid().size() <= kMostTiles; };
  const RenderReport report = map.render(scans.placed, std::ref(reader), Precision::kExact, [&] {
    return fits() && (!asked.keep_going || asked.keep_going());
  });
  if (!fits())
    return Error{ErrorCode::kNotUsable,
                 "the map needs more than 1 GB; choose larger cells with --resolution, or one "
                 "robot with --robot"};
  if (!report.finished) return Error{ErrorCode::kInternal, "interrupted"};
  const std::string counts = std::to_string(scans.payloads.size()) + " payloads, of which " +
                             std::to_string(reader.missing) + " have not come";
  if (reader.scans == 0)
    return Error{ErrorCode::kNotUsable,
                 "no pose of this map has a laser scan (" + counts + "): there is no map to draw"};
  Result<MapImage> image = draw_map(map.grid(), resolution_m, model);
  if (!image) return image.error();
  return RenderedMap{std::move(*image), reader.scans, reader.missing};
}

Result<double> resolution_of(const Question& question) {
  const auto found = question.options.find("resolution");
  if (found == question.options.end()) return 0.05;
  const double resolution_m = found->is_number() ? found->get<double>() : 0.0;
  if (resolution_m >= kLeastCell && resolution_m <= kLargestCell) return resolution_m;
  return Error{ErrorCode::kUsage, "--resolution must be between 0.01 and 10 m"};
}

Result<MapModel> model_of(const Question& question) {
  const std::string name = question.text("model");
  if (name.empty() || name == "occupancy") return MapModel::kOccupancy;
  if (name == "reflection") return MapModel::kReflection;
  return Error{ErrorCode::kUsage, "--model must be occupancy or reflection"};
}

}  // namespace

Result<std::string> answer_export_map(const Question& question, const Asked& asked) {
  const auto known = question.check_options({"robot", "live", "resolution", "model", "with_graph"});
  if (!known) return known.error();
  const Result<double> resolution_m = resolution_of(question);
  if (!resolution_m) return resolution_m.error();
  const Result<MapModel> model = model_of(question);
  if (!model) return model.error();
  const Result<ExportContent> content = collect_export(question, asked);
  if (!content) return content.error();
  const Result<ScansOfMap> scans = find_scans(*content, question.text("robot"));
  if (!scans) return scans.error();
  const Result<RenderedMap> map = render(*scans, *resolution_m, *model, asked);
  if (!map) return map.error();
  const nlohmann::ordered_json counts{{"scans", map->scans}, {"missing", map->missing}};
  NamedFiles files{{"map", to_text(map->image)}, {"counts", dump(counts, -1)}};
  if (question.flag("with_graph")) {
    const auto graph = export_graph_text(*content, choose_export_ids(*content));
    if (!graph) return graph.error();
    files.emplace_back("graph", *graph);
  }
  return join_files(files);
}

}  // namespace cairn
