// SPDX-License-Identifier: BSD-3-Clause
#include "idl/convert.hpp"
#include "idl/wire_checks.hpp"

namespace cairn::wire {
namespace {

cairn_wire_Source_status to_wire(const SourceStatus& status, Arena& arena) {
  cairn_wire_Source_status wire{};
  wire.source = lend(status.source);
  wire.epoch = status.epoch;
  wire.alive = status.alive;
  wire.highest_decided = status.highest_decided;
  wire.accepted = status.accepted;
  wire.refused = status.refused;
  wire.held = status.held;
  wire.clock_offset_ns = status.clock_offset_ns;
  wire.last_refusal = lend_cut(status.last_refusal, limits::kReason, arena);
  auto* counts = make_sequence(wire.refused_by_code, status.refused_by_code.size(), arena);
  for (const auto& [code, count] : status.refused_by_code)
    *counts++ = {.refusal = static_cast<std::uint8_t>(code), .count = count};
  return wire;
}

SourceStatus read_source(Checks& checks, const cairn_wire_Source_status& wire) {
  SourceStatus status{
      .source = checks.name("source", wire.source),
      .epoch = wire.epoch,
      .alive = wire.alive,
      .highest_decided = wire.highest_decided,
      .accepted = wire.accepted,
      .refused = wire.refused,
      .held = wire.held,
      .clock_offset_ns = wire.clock_offset_ns,
      .last_refusal = checks.text("last_refusal", wire.last_refusal, limits::kReason)};
  if (checks.count("refused_by_code", wire.refused_by_code._length, 256)) {
    const auto* counts = wire.refused_by_code._buffer;
    for (std::uint32_t i = 0; i < wire.refused_by_code._length; ++i)
      status.refused_by_code.emplace_back(static_cast<RefusalCode>(counts[i].refusal),
                                          counts[i].count);
  }
  return status;
}

}  // namespace

cairn_wire_Command to_wire(const Command& command, Arena&) {
  return {.client = command.key.client,
          .version = kVersion,
          .number = command.key.number,
          .text = lend(command.text)};
}

Result<Command> from_wire(const cairn_wire_Command& wire) {
  Checks checks;
  checks.version(wire.version);
  return checks.result(Command{.key = {.client = wire.client, .number = wire.number},
                               .text = checks.text("text", wire.text, limits::kText)});
}

cairn_wire_Status to_wire(const Status& status, Arena& arena) {
  cairn_wire_Status wire{};
  wire.started_ns = status.started_ns;
  wire.store = status.head.store;
  wire.version = kVersion;
  wire.program_version = lend_cut(status.version, limits::kWord, arena);
  wire.host = lend_cut(status.host, limits::kReason, arena);
  wire.state = static_cast<std::uint8_t>(status.state);
  wire.head = to_wire(status.head);
  wire.revisions = to_wire(status.estimate);
  wire.variables = status.variables;
  wire.factors = status.factors;
  wire.chi2 = status.chi2;
  wire.memory_bytes = status.memory_bytes;
  wire.disk_free_bytes = status.disk_free_bytes;
  wire.message = lend_cut(status.message, limits::kReason, arena);
  const std::size_t count = std::min(status.sources.size(), limits::kSources);
  auto* sources = make_sequence(wire.sources, count, arena);
  for (std::size_t i = 0; i < count; ++i) sources[i] = to_wire(status.sources[i], arena);
  double* datum = make_sequence(wire.datum, status.datum ? 3 : 0, arena);
  if (status.datum) {
    *datum++ = status.datum->latitude_deg;
    *datum++ = status.datum->longitude_deg;
    *datum = status.datum->height_m;
  }
  return wire;
}

Result<Status> from_wire(const cairn_wire_Status& wire) {
  Checks checks;
  checks.version(wire.version);
  Status status;
  status.started_ns = wire.started_ns;
  status.version = checks.text("program_version", wire.program_version, limits::kWord);
  status.host = checks.text("host", wire.host, limits::kReason);
  status.state = checks.word("state", wire.state, DaemonState::kStopping);
  status.head = from_wire(wire.head);
  status.estimate = from_wire(wire.revisions);
  status.variables = wire.variables;
  status.factors = wire.factors;
  status.chi2 = wire.chi2;
  status.memory_bytes = wire.memory_bytes;
  status.disk_free_bytes = wire.disk_free_bytes;
  status.message = checks.text("message", wire.message, limits::kReason);
  if (checks.count("sources", wire.sources._length, limits::kSources))
    for (std::uint32_t i = 0; i < wire.sources._length; ++i)
      status.sources.push_back(read_source(checks, wire.sources._buffer[i]));
  const std::vector<double> datum = checks.numbers("datum", wire.datum, 3);
  if (datum.size() == 3) status.datum = Geodetic{datum[0], datum[1], datum[2]};
  return checks.result(std::move(status));
}

cairn_wire_Event to_wire(const Event& event, Arena& arena) {
  static const std::string kNothing;
  cairn_wire_Event wire{};
  wire.version = kVersion;
  wire.number = event.number;
  wire.time_ns = event.time_ns;
  wire.severity = static_cast<std::uint8_t>(event.severity);
  wire.event_kind = lend_cut(event.kind, limits::kWord, arena);
  wire.revision = to_wire(event.revision);
  wire.has_factor = event.factor.has_value();
  wire.factor.source = lend(event.factor ? event.factor->transaction.source : kNothing);
  if (event.factor) {
    wire.factor.epoch = event.factor->transaction.epoch;
    wire.factor.sequence_number = event.factor->transaction.sequence;
    wire.factor.index = event.factor->index;
  }
  wire.text = lend_cut(event.text, limits::kText, arena);
  return wire;
}

Result<Event> from_wire(const cairn_wire_Event& wire) {
  Checks checks;
  checks.version(wire.version);
  Event event{.number = wire.number,
              .time_ns = wire.time_ns,
              .severity = checks.word("severity", wire.severity, Severity::kError),
              .kind = checks.text("event_kind", wire.event_kind, limits::kWord),
              .revision = from_wire(wire.revision),
              .factor = {},
              .text = checks.text("text", wire.text, limits::kText)};
  if (wire.has_factor)
    event.factor = FactorName{.transaction = {.source = checks.name("source", wire.factor.source),
                                              .epoch = wire.factor.epoch,
                                              .sequence = wire.factor.sequence_number},
                              .index = wire.factor.index};
  return checks.result(std::move(event));
}

}  // namespace cairn::wire
