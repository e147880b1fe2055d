// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace cairn {

/// What decides, beside our own code, how results round here: "libm glibc 2.36 fma; openblas
/// Haswell". Solves are bit-comparable where this text is the same.
std::string describe_platform();

}  // namespace cairn
