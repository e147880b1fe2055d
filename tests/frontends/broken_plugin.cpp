// SPDX-License-Identifier: BSD-3-Clause
// Shared objects that are no front-end, each in its way: compiled with another SYMBOL, VERSION
// or MAKE.
#include "frontends/api/frontend.hpp"

namespace {
[[maybe_unused]] cairn::Frontend* make_nothing() { return nullptr; }
}  // namespace

extern "C" const cairn::FrontendPlugin SYMBOL{VERSION, "broken", MAKE};
