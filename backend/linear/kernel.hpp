// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace cairn {

/// The instruction set of our dense kernels. They differ in rounding: who wants the same bits on
/// every processor asks for kPortable.
enum class Kernel : std::uint8_t { kFastest, kPortable, kAvx2, kAvx512 };

/// False where this processor or build lacks it.
bool is_runnable(Kernel kernel);

}  // namespace cairn
