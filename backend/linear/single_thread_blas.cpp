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

SingleThreadBlas::SingleThreadBlas()
    : openmp_levels_(omp_get_max_active_levels()), blas_threads_(openblas_get_num_threads()) {
  omp_set_max_active_levels(0);
  // Setting an unchanged count still takes a lock and may start threads.
  if (blas_threads_ != 1) openblas_set_num_threads(1);
}

SingleThreadBlas::~SingleThreadBlas() {
  omp_set_max_active_levels(openmp_levels_);
  if (blas_threads_ != 1) openblas_set_num_threads(blas_threads_);
}

}  // namespace cairn
