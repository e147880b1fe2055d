// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "cairn/core/result.hpp"

namespace cairn {

/// The text of one input, in memory.
struct InputText {
  std::shared_ptr<const void> owner;
  std::string_view view;
};

/// Reads a whole file, or standard input for "-", and decompresses it when its content is gzip or
/// bzip2. At most half of this machine's memory.
Result<InputText> read_input_text(const std::string& path);

/// What messages call an input: "<stdin>" for "-", otherwise the path.
std::string input_name(const std::string& path);

}  // namespace cairn
