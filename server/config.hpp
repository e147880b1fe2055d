// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "cairn/core/result.hpp"
#include "idl/dds/entity.hpp"
#include "server/ros_map.hpp"
#include "server/service.hpp"

namespace cairn {

enum class LogFormat { kText, kJson };

/// What an operator may set; the defaults are those of the product.
struct DaemonConfig {
  std::uint32_t domain = 0;
  dds::Network network{};
  LogFormat log_format = LogFormat::kText;
  Severity log_from = Severity::kInfo;
  ServiceOptions service{};
  std::size_t journal_buffer_bytes = JournalOptions{}.write_buffer_bytes;
  RosMapOptions ros{};  ///< its network is that of the daemon
};

/// Reads a YAML file over `config`: keys that it does not name stay as they are. An error names
/// file:line:column: keys that do not exist, values out of their range, what is not YAML.
Result<void> read_config(const std::string& path, DaemonConfig& config);
/// The same for text in memory; `name` stands for the file in errors.
Result<void> read_config_text(const std::string& text, const std::string& name,
                              DaemonConfig& config);

/// The whole configuration as YAML, each key with what it does and what it may be.
std::string dump_config(const DaemonConfig& config);

}  // namespace cairn
