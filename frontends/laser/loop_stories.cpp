// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/laser/loop_stories.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cairn {

Se2 LoopStories::first_map_second_map(const Sighting& s, const Map& map) {
  const Se2 T = map.pose_of(s.from) * s.T_from_to * map.pose_of(s.to).inverse();
  return s.from.frame < s.to.frame ? T : T.inverse();
}

// Whether two sightings put the maps to each other in the same way, seen from where `b` was: maps
// drift, so what was long ago says less.
bool LoopStories::agree(const Sighting& a, const Sighting& b, const Map& map) const {
  const Se2 there = map.pose_of(b.from.frame < b.to.frame ? b.to : b.from);
  const Se2 apart =
      (first_map_second_map(a, map) * there).inverse() * (first_map_second_map(b, map) * there);
  return apart.translation().norm() <= options_.agree_m &&
         std::abs(apart.theta()) <= options_.agree_rad;
}

// Long enough, possible, and no other possible one is about as long.
bool LoopStories::convinces(const Story& story, const Map& map) const {
  if (story.told) return true;
  if (story.sightings.size() < options_.least_agreeing) return false;
  const auto way = [&](NodeId Sighting::*end) {
    const Eigen::Vector2d first = map.pose_of(story.sightings.front().*end).translation();
    double farthest = 0.0;
    for (const Sighting& s : story.sightings)
      farthest = std::max(farthest, (map.pose_of(s.*end).translation() - first).norm());
    return farthest;
  };
  const auto is_contradicted = [&](const Story& what) {
    return map.contradicts && map.contradicts(what.sightings.back());
  };
  if (std::min(way(&Sighting::from), way(&Sighting::to)) < options_.least_way_m ||
      is_contradicted(story))
    return false;
  const double doubt = options_.most_doubt * static_cast<double>(story.sightings.size());
  return std::none_of(stories_.begin(), stories_.end(), [&](const Story& other) {
    return &other != &story && static_cast<double>(other.sightings.size()) > doubt &&
           !is_contradicted(other);
  });
}

std::vector<Sighting> LoopStories::hear(const Sighting& sighting, const Map& map) {
  auto story = std::find_if(stories_.begin(), stories_.end(), [&](const Story& known) {
    return agree(known.sightings.back(), sighting, map);
  });
  if (story == stories_.end()) story = stories_.insert(stories_.end(), Story{});
  story->sightings.push_back(sighting);
  if (!convinces(*story, map)) return {};
  return std::exchange(story->told, true) ? std::vector<Sighting>{sighting} : story->sightings;
}

}  // namespace cairn
