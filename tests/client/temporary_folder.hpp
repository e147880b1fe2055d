// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/support/temporary_folder.hpp"
