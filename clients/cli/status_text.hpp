// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace cairn::cli {

/// A daemon's or a folder's status, as server/status_json.hpp makes it, for people.
std::string text_of_status(const nlohmann::ordered_json& status);

}  // namespace cairn::cli
