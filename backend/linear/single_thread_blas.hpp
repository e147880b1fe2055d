// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace cairn {

/// Holds BLAS and CHOLMOD's OpenMP regions to one thread while it lives, from inside the program:
/// CHOLMOD asks for four threads in every supernode whatever the environment says, and loses half
/// of the time to the scheduler. Applies to the calling thread (OpenMP) and to the process
/// (OpenBLAS), until the last of those who live at once ends; then the former settings come back.
class SingleThreadBlas {
 public:
  SingleThreadBlas();
  ~SingleThreadBlas();
  SingleThreadBlas(const SingleThreadBlas&) = delete;
  SingleThreadBlas& operator=(const SingleThreadBlas&) = delete;

 private:
  int openmp_levels_;
};

}  // namespace cairn
