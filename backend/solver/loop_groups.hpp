// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "cairn/solver/loop_cycles.hpp"

namespace cairn {

/// Of chi-square with so many degrees of freedom (Wilson and Hilferty 1931).
double median_chi2(int dimension);
/// The chi2 that a loop closure may have, times a measured noise scale: 102 in the plane, 50 in
/// space. No theory says so: public graphs have true ones far out, in the plane more than in space.
double largest_chi2(int dimension);
double median(std::vector<double> values);

/// The noise scale that a gate works with, where loops have `measured` one: an error that five of
/// six true loops exceed by what they state of themselves is no reason to leave one out, unless the
/// others are ten times as good.
double trusted_noise_scale(double measured);

/// What loops say about each other, before anything is solved. Loops by their places in
/// LoopCycles::loops().
struct LoopGroups {
  /// Nearby loops that agree with its first one, which stands for all. A loop between two chains of
  /// odometry that no nearby one supports is a group, too: it may be one of few that tie them.
  struct Group {
    std::vector<std::size_t> loops;
    bool in = true;  ///< no more loops speak against it than for it
  };
  std::vector<Group> groups;
  std::vector<std::pair<std::size_t, std::size_t>> agreeing;  ///< nearby ones, copies too
  std::vector<bool> supported;                                ///< in a group of several that is in
  std::vector<bool> contradicted;                             ///< in one that is not
  double noise_scale = 1.0;  ///< 1 where too few nearby loops measure it
};

/// Groups loops that support each other over short stretches of odometry, and leaves out, the
/// weakest first, those that contradict others over long ones. Nothing where `keep_going` says so.
template <class Pose>
std::optional<LoopGroups> find_groups(const LoopCycles<Pose>& cycles,
                                      const std::function<bool()>& keep_going);

}  // namespace cairn
