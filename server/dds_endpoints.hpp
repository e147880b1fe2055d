// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "idl/dds/endpoint.hpp"

namespace cairn {

/// Everything the daemon reads and writes in one domain.
struct DaemonEndpoints {
  dds::Reader<cairn_wire_Transaction> transaction;
  dds::Reader<cairn_wire_Client_state> client_state;
  dds::Reader<cairn_wire_Payload> payload;
  dds::Reader<cairn_wire_Command> command;
  dds::Reader<cairn_wire_Tile_request> tile_request;
  dds::Reader<cairn_wire_Status> rival;
  dds::Writer<cairn_wire_Receipt> receipt;
  dds::Writer<cairn_wire_Source_state> source_state;
  dds::Writer<cairn_wire_Payload_receipt> payload_receipt;
  dds::Writer<cairn_wire_Poses> poses;
  dds::Writer<cairn_wire_Landmarks> landmarks;
  dds::Writer<cairn_wire_Correction> correction;
  dds::Writer<cairn_wire_Tile_index> tile_index;
  dds::Writer<cairn_wire_Occupancy_tile> tiles;
  dds::Writer<cairn_wire_Status> status;
  dds::Writer<cairn_wire_Event> event;
  dds::Writer<cairn_wire_Reply> reply;

  static Result<DaemonEndpoints> make(const dds::Participant& in,
                                      const dds::TroubleHandler* trouble) {
    return dds::collect<DaemonEndpoints>(dds::Reader<cairn_wire_Transaction>::make(in, trouble),
                                         dds::Reader<cairn_wire_Client_state>::make(in, trouble),
                                         dds::Reader<cairn_wire_Payload>::make(in, trouble),
                                         dds::Reader<cairn_wire_Command>::make(in, trouble),
                                         dds::Reader<cairn_wire_Tile_request>::make(in, trouble),
                                         dds::Reader<cairn_wire_Status>::make(in, trouble),
                                         dds::Writer<cairn_wire_Receipt>::make(in, trouble),
                                         dds::Writer<cairn_wire_Source_state>::make(in, trouble),
                                         dds::Writer<cairn_wire_Payload_receipt>::make(in, trouble),
                                         dds::Writer<cairn_wire_Poses>::make(in, trouble),
                                         dds::Writer<cairn_wire_Landmarks>::make(in, trouble),
                                         dds::Writer<cairn_wire_Correction>::make(in, trouble),
                                         dds::Writer<cairn_wire_Tile_index>::make(in, trouble),
                                         dds::Writer<cairn_wire_Occupancy_tile>::make(in, trouble),
                                         dds::Writer<cairn_wire_Status>::make(in, trouble),
                                         dds::Writer<cairn_wire_Event>::make(in, trouble),
                                         dds::Writer<cairn_wire_Reply>::make(in, trouble));
  }
};

}  // namespace cairn
