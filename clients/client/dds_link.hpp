// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>

#include "idl/dds/entity.hpp"
#include "idl/link.hpp"

namespace cairn {

struct DdsLinkOptions {
  std::uint32_t domain = 0;
  dds::Network network{};  ///< where CYCLONEDDS_URI is not set
};

/// A client's side of the wire over Cyclone DDS. Listener calls come from a thread of its own.
std::unique_ptr<Link> make_dds_link(const DdsLinkOptions& options, Link::Identity identity);

}  // namespace cairn
