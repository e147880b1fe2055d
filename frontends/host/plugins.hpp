// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "cairn/core/result.hpp"
#include "frontends/api/frontend.hpp"

namespace cairn {

/// A front-end by the name of one that is built in ("laser"), or by the path of a shared object
/// (something with a '/', or that ends in .so), which stays loaded.
Result<std::unique_ptr<Frontend>> make_frontend(const std::string& name,
                                                const FrontendRoles& roles = {});

}  // namespace cairn
