// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "idl/map_messages.hpp"

namespace cairn {

/// Hears of the daemon's maps within its process: ServiceOptions::maps.on_map. Called from the map
/// service's thread when a rendering has been published, in order, and once for each map that it
/// has changed; the first calls bring all there is. MapChange::resolution_m is the same in all of
/// them. It may take its time: rendering and tiles for clients wait meanwhile, nothing else does.
/// It must not call the service, and end soon when the service stops.
///
///   options.maps.on_map = [&](const MapChange& change) { grids[change.map].take(change); };
using MapObserver = std::function<void(const MapChange&)>;

}  // namespace cairn
