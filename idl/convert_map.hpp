// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cairn/map.h>

#include "idl/convert.hpp"
#include "idl/map_messages.hpp"

namespace cairn::wire {

/// As those of convert.hpp.
cairn_wire_Tile_index to_wire(const TileBlock& block, Arena& arena);
cairn_wire_Tile_request to_wire(const TileRequest& request, Arena& arena);
cairn_wire_Occupancy_tile to_wire(const TileAnswer& answer, Arena& arena);

Result<TileBlock> from_wire(const cairn_wire_Tile_index& wire);
Result<TileRequest> from_wire(const cairn_wire_Tile_request& wire);
Result<TileAnswer> from_wire(const cairn_wire_Occupancy_tile& wire);

}  // namespace cairn::wire
