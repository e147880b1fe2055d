// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/linear/front_kernels.hpp"

namespace cairn {

extern const FrontKernels kPortableFrontKernels;
#ifdef __x86_64__
extern const FrontKernels kAvx2FrontKernels;
extern const FrontKernels kAvx512FrontKernels;
#endif

std::vector<const FrontKernels*> runnable_front_kernels() {
  std::vector<const FrontKernels*> sets{&kPortableFrontKernels};
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    sets.push_back(&kAvx2FrontKernels);
  if (__builtin_cpu_supports("avx512f")) sets.push_back(&kAvx512FrontKernels);
#endif
  return sets;
}

const FrontKernels* find_front_kernels(Kernel kernel) {
  const std::vector<const FrontKernels*> runnable = runnable_front_kernels();
  if (kernel == Kernel::kFastest) return runnable.back();
  for (const FrontKernels* set : runnable) {
    if (set->kernel == kernel) return set;
  }
  return nullptr;
}

bool is_runnable(Kernel kernel) { return find_front_kernels(kernel) != nullptr; }

}  // namespace cairn
