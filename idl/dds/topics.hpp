// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "idl/convert_map.hpp"
#include "idl/dds/entity.hpp"

namespace cairn::dds {

/// How the samples of a topic are treated; idl/README.md has the table.
enum class Traffic {
  kLatest,           ///< reliable, the newest of each instance kept for late joiners
  kEvery,            ///< reliable, all of them, to those who are there
  kBulk,             ///< reliable, the newest of each instance, to those who are there
  kSensor,           ///< best effort, the newest 20, to those who are there
  kTransforms,       ///< reliable, the newest 100, to those who are there
  kFixedTransforms,  ///< reliable, the newest 100, kept for late joiners
};

/// Name, type and traffic of the topic that carries T.
template <class T>
struct Topic;

#define CAIRN_TOPIC(Type, name, traffic)                                                    \
  template <>                                                                               \
  struct Topic<cairn_wire_##Type> {                                                         \
    static constexpr const char* kName = name;                                              \
    static constexpr Traffic kTraffic = Traffic::traffic;                                   \
    static const dds_topic_descriptor_t* descriptor() { return &cairn_wire_##Type##_desc; } \
  }

CAIRN_TOPIC(Transaction, "cairn/transaction", kLatest);
CAIRN_TOPIC(Receipt, "cairn/receipt", kLatest);
CAIRN_TOPIC(Source_state, "cairn/source_state", kLatest);
CAIRN_TOPIC(Client_state, "cairn/client_state", kLatest);
CAIRN_TOPIC(Payload, "cairn/payload", kBulk);
CAIRN_TOPIC(Payload_receipt, "cairn/payload_receipt", kBulk);
CAIRN_TOPIC(Poses, "cairn/poses", kLatest);
CAIRN_TOPIC(Landmarks, "cairn/landmarks", kLatest);
CAIRN_TOPIC(Correction, "cairn/correction", kLatest);
CAIRN_TOPIC(Command, "cairn/command", kEvery);
CAIRN_TOPIC(Reply, "cairn/reply", kEvery);
CAIRN_TOPIC(Status, "cairn/status", kLatest);
CAIRN_TOPIC(Event, "cairn/event", kEvery);
CAIRN_TOPIC(Tile_index, "cairn/tile_index", kLatest);
CAIRN_TOPIC(Tile_request, "cairn/tile_request", kBulk);
CAIRN_TOPIC(Occupancy_tile, "cairn/occupancy_tile", kBulk);

#undef CAIRN_TOPIC

/// The same for readers and writers of a topic, so that they always fit each other.
Qos make_qos(Traffic traffic);

}  // namespace cairn::dds
