// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/linear/platform.hpp"

#include <gnu/libc-version.h>

extern "C" char* openblas_get_corename(void);

namespace cairn {

std::string describe_platform() {
  std::string text = std::string("libm glibc ") + gnu_get_libc_version();
#if defined(__x86_64__)
  // The C library chooses among variants of its functions by these features.
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    text += " fma";
  else
    text += " sse2";
#endif
  return text + "; openblas " + openblas_get_corename();
}

}  // namespace cairn
