// SPDX-License-Identifier: BSD-3-Clause
#define CAIRN_FRONT_KERNELS kAvx512FrontKernels
#include "cairn/linear/front_kernels_body.hpp"
