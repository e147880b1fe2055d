// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>

#include "idl/dds/entity.hpp"
#include "server/transport.hpp"

namespace cairn {

struct DdsTransportOptions {
  std::uint32_t domain = 0;
  dds::Network network{};  ///< where CYCLONEDDS_URI is not set
};

/// The daemon's side of the wire over Cyclone DDS. Listener calls come from a thread of its own.
std::unique_ptr<Transport> make_dds_transport(const DdsTransportOptions& options);

}  // namespace cairn
