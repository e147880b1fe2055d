// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/linear/single_thread_blas.hpp"

#include <mutex>

// libgomp's, on which CHOLMOD runs whichever compiler builds us (so not <omp.h>).
extern "C" {
int omp_get_max_active_levels(void);
void omp_set_max_active_levels(int levels);
int openblas_get_num_threads(void);
void openblas_set_num_threads(int count);
}

namespace cairn {
namespace {

/// OpenBLAS has one number of threads for the process: the first who holds it to one sets that, and
/// the last who lets go brings back what was before.
struct {
  std::mutex mutex;
  int holders = 0, threads_before = 1;
} blas;

}  // namespace

SingleThreadBlas::SingleThreadBlas() : openmp_levels_(omp_get_max_active_levels()) {
  omp_set_max_active_levels(0);
  const std::lock_guard lock(blas.mutex);
  if (blas.holders++ > 0) return;
  blas.threads_before = openblas_get_num_threads();
  // Setting an unchanged count still takes a lock and may start threads.
  if (blas.threads_before != 1) openblas_set_num_threads(1);
}

SingleThreadBlas::~SingleThreadBlas() {
  omp_set_max_active_levels(openmp_levels_);
  const std::lock_guard lock(blas.mutex);
  if (--blas.holders == 0 && blas.threads_before != 1)
    openblas_set_num_threads(blas.threads_before);
}

}  // namespace cairn
