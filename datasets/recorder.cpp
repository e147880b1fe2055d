// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/recorder.hpp"

namespace cairn {

// Exactly `count` of `total`, each choice equally likely, in order (Knuth, TAOCP 2, 3.4.2,
// algorithm S).
std::vector<bool> choose(std::size_t count, std::size_t total, Random& random) {
  std::vector<bool> chosen(total, false);
  for (std::size_t i = 0; i < total && count > 0; ++i) {
    if (random.index(total - i) < count) chosen[i] = true, --count;
  }
  return chosen;
}

}  // namespace cairn
