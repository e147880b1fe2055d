// SPDX-License-Identifier: BSD-3-Clause
#define CAIRN_FRONT_KERNELS kPortableFrontKernels
#include "cairn/linear/front_kernels_body.hpp"
