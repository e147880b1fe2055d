// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <set>
#include <span>

#include "cairn/maps/grid.hpp"

namespace cairn {

/// Names a scan for ever: what it was given once, it always holds.
using ScanId = std::uint64_t;

/// A scan that a map is to show, and where the robot was.
struct PlacedScan {
  ScanId scan = 0;
  Se2 T_map_body;
};

/// Gives a scan; null while it has not come yet.
using ScanSource = std::function<std::shared_ptr<const RangeScan>(ScanId)>;

enum class Precision : std::uint8_t {
  kTolerant,  ///< a scan that has moved less than a tenth of a cell and 0.05 deg stays as it is
  kExact,     ///< every scan is where it is
};

/// What a rendering did.
struct RenderReport {
  std::size_t added = 0;          ///< scans that were new or elsewhere
  std::size_t kept = 0;           ///< scans that stayed as they were rendered before
  std::size_t missing = 0;        ///< scans that have not come yet: they are not in the map
  std::set<TileIndex> changed{};  ///< tiles that may be different, or gone
  bool finished = true;           ///< false: it was told to stop, and is to be called again
};

/// A map as a function of scans and poses, kept up to date: of what has moved the old contribution
/// is taken away, to the bit, and the new one added. So the grid is always what rendering all scans
/// from nothing at `rendered_poses` gives. `Traced` is LaserCells or SonarCells. One thread.
template <class Cell, class Traced>
class MapRenderer {
 public:
  /// `resolution_m`: side of a cell, above 0.
  explicit MapRenderer(double resolution_m, Traced model = Traced())
      : resolution_m_(resolution_m), traced_(std::move(model)) {}

  /// Makes the map show these scans (each id once) and no others. `keep_going` is asked now and
  /// then; where it says no, the map is left half way.
  RenderReport render(std::span<const PlacedScan> scans, const ScanSource& source,
                      Precision precision, const std::function<bool()>& keep_going = {});

  [[nodiscard]] const Grid<Cell>& grid() const { return grid_; }
  [[nodiscard]] double resolution_m() const { return resolution_m_; }
  /// What the grid was made from: the map is a function of it alone.
  [[nodiscard]] const std::map<ScanId, Se2>& rendered_poses() const { return rendered_; }

 private:
  [[nodiscard]] bool is_close(const Se2& a, const Se2& b, Precision precision) const;
  /// What is to be taken away, and then to be added.
  struct Plan {
    std::vector<ScanId> leave;
    std::vector<PlacedScan> come;
  };
  Plan plan(std::span<const PlacedScan> scans, Precision precision, RenderReport& report);
  Plan begin_again(std::span<const PlacedScan> scans, RenderReport& report);
  bool change(ScanId scan, const Se2& T_map_body, Sign sign, const ScanSource& source,
              RenderReport& report);

  double resolution_m_;
  Traced traced_;
  Grid<Cell> grid_;
  std::map<ScanId, Se2> rendered_;
};

/// What lasers make.
using LaserMap = MapRenderer<HitMissCell, LaserCells>;
using SonarMap = MapRenderer<LogOddsCell, SonarCells>;

extern template class MapRenderer<HitMissCell, LaserCells>;
extern template class MapRenderer<LogOddsCell, SonarCells>;

}  // namespace cairn
