// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/solver/loop_groups.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cairn {
namespace {

constexpr double kLeastScale = 1e-3;        // noise-free data would refuse its own rounding errors
constexpr std::size_t kLeastPairs = 20;     // that make a noise scale
constexpr std::size_t kMostCompared = 300;  // groups behind each, in the order of loops()
constexpr double kStatedScale = 0.05;
constexpr double kMostTimesMeasured = 10;

struct Pair {
  std::size_t x, y;
  bool copies;  ///< of one pair of poses: no second witness
  double chi2;
};

template <class Pose>
class Grouping {
 public:
  explicit Grouping(const LoopCycles<Pose>& cycles) : cycles_(cycles) {
    result_.supported.resize(loops().size());
    result_.contradicted.resize(loops().size());
  }

  std::optional<LoopGroups> run(const std::function<bool()>& keep_going) {
    std::vector<Pair> near = nearby_pairs();
    measure_noise(near);
    std::erase_if(near, [&](const Pair& pair) { return pair.chi2 > threshold(); });
    group(near);
    if (!find_contradictions(keep_going)) return std::nullopt;
    while (const auto worst = most_contradicted()) leave_out(*worst);
    return std::move(result_);
  }

 private:
  static constexpr int kDimension = UncertainPose<Pose>::kDimension;
  using Loop = typename LoopCycles<Pose>::Loop;

  [[nodiscard]] const std::vector<Loop>& loops() const { return cycles_.loops(); }
  [[nodiscard]] double threshold() const { return largest_chi2(kDimension) * result_.noise_scale; }

  [[nodiscard]] std::vector<Pair> nearby_pairs() const {
    std::vector<Pair> near;
    for (std::size_t x = 0; x < loops().size(); ++x) {
      for (std::size_t y = x + 1; y < loops().size(); ++y) {
        const Loop &first = loops()[x], &second = loops()[y];
        if (!cycles_.nearby(first, second)) break;
        const int distance = cycles_.distance(first, second);
        if (distance <= kReach) near.push_back({x, y, distance == 0, cycles_.chi2(first, second)});
      }
    }
    return near;
  }

  void measure_noise(const std::vector<Pair>& near) {
    std::vector<double> all;
    for (const Pair& pair : near)
      if (!pair.copies) all.push_back(pair.chi2);
    if (all.size() < kLeastPairs) return;
    result_.noise_scale = trusted_noise_scale(median(std::move(all)) / median_chi2(kDimension));
  }

  // Every loop that a nearby one agrees with, into one group: that of the first that does.
  void group(const std::vector<Pair>& agreeing) {
    std::vector<std::vector<std::size_t>> partners(loops().size());
    for (const Pair& pair : agreeing) {
      result_.agreeing.emplace_back(pair.x, pair.y);
      if (pair.copies) continue;
      partners[pair.x].push_back(pair.y);
      partners[pair.y].push_back(pair.x);
      result_.supported[pair.x] = result_.supported[pair.y] = true;
    }
    std::vector<bool> taken(loops().size());
    for (std::size_t seed = 0; seed < loops().size(); ++seed) {
      if (taken[seed] || !(result_.supported[seed] || cycles_.leads_elsewhere(loops()[seed])))
        continue;
      LoopGroups::Group group{.loops = {seed}};
      taken[seed] = true;
      for (const std::size_t partner : partners[seed]) {
        if (taken[partner]) continue;
        taken[partner] = true;
        group.loops.push_back(partner);
      }
      result_.groups.push_back(std::move(group));
    }
  }

  [[nodiscard]] double size(std::size_t group) const {
    return static_cast<double>(result_.groups[group].loops.size());
  }

  bool find_contradictions(const std::function<bool()>& keep_going) {
    const auto& groups = result_.groups;
    foes_.resize(groups.size());
    against_.resize(groups.size(), 0.0);
    for (std::size_t x = 0; x < groups.size(); ++x) {
      if (keep_going && !keep_going()) return false;
      const Loop& first = loops()[groups[x].loops.front()];
      const std::size_t end = std::min(groups.size(), x + 1 + kMostCompared);
      for (std::size_t y = x + 1; y < end; ++y) {
        const Loop& second = loops()[groups[y].loops.front()];
        if (!cycles_.share_chains(first, second)) break;
        if (cycles_.chi2(first, second) <= threshold()) continue;
        foes_[x].push_back(y);
        foes_[y].push_back(x);
        against_[x] += size(y);
        against_[y] += size(x);
      }
    }
    return true;
  }

  // That most loops speak against, per loop that speaks for it.
  [[nodiscard]] std::optional<std::size_t> most_contradicted() const {
    std::optional<std::size_t> worst;
    double most = 0.0;
    for (std::size_t x = 0; x < result_.groups.size(); ++x) {
      const double odds = against_[x] / size(x);
      if (!result_.groups[x].in || odds <= most) continue;
      most = odds;
      worst = x;
    }
    return worst;
  }

  void leave_out(std::size_t group) {
    result_.groups[group].in = false;
    for (const std::size_t foe : foes_[group]) against_[foe] -= size(group);
    for (const std::size_t loop : result_.groups[group].loops) {
      result_.supported[loop] = false;
      result_.contradicted[loop] = true;
    }
  }

  const LoopCycles<Pose>& cycles_;
  std::vector<std::vector<std::size_t>> foes_;  // by group
  std::vector<double> against_;                 // by group: loops in those of its foes that are in
  LoopGroups result_;
};

}  // namespace

double median_chi2(int dimension) {
  const double d = dimension;
  return d * std::pow(1.0 - 2.0 / (9.0 * d), 3);
}

double largest_chi2(int dimension) { return dimension <= 3 ? 102.0 : 50.0; }

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double trusted_noise_scale(double measured) {
  return std::max({kLeastScale, measured, std::min(kStatedScale, kMostTimesMeasured * measured)});
}

template <class Pose>
std::optional<LoopGroups> find_groups(const LoopCycles<Pose>& cycles,
                                      const std::function<bool()>& keep_going) {
  return Grouping<Pose>(cycles).run(keep_going);
}

template std::optional<LoopGroups> find_groups(const LoopCycles<Se2>&,
                                               const std::function<bool()>&);
template std::optional<LoopGroups> find_groups(const LoopCycles<Se3>&,
                                               const std::function<bool()>&);

}  // namespace cairn
