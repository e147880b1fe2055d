// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/replay/estimate_snapshot.hpp"

#include "cairn/core/bytes.hpp"

namespace cairn {
namespace {

constexpr std::uint16_t kVersion = 1;

}  // namespace

std::string encode_snapshot(const PoseGraph& map, double chi2) {
  std::string bytes;
  bytes.reserve(64 + map.estimates.size() * sizeof(Estimate));
  ByteWriter out(bytes);
  out.integer(kVersion);
  out.integer(map.solved_revision.store);
  out.integer(map.solved_revision.era);
  out.integer(map.solved_revision.number);
  out.real(chi2);
  out.count(map.estimates.size());
  for (std::size_t i = 0; i < map.estimates.size(); ++i) {
    for (const double number : map.estimates[i]) out.real(number);
  }
  return bytes;
}

Result<EstimateSnapshot> decode_snapshot(std::string_view bytes) {
  ByteReader in(bytes);
  const auto version = in.integer<std::uint16_t>();
  if (version != kVersion) {
    return Error{ErrorCode::kBadInput,
                 "a snapshot of version " + std::to_string(version) + "; expected 1"};
  }
  EstimateSnapshot snapshot;
  snapshot.solved.store = in.integer<std::uint64_t>();
  snapshot.solved.era = in.integer<std::uint32_t>();
  snapshot.solved.number = in.integer<std::uint64_t>();
  snapshot.chi2 = in.real();
  snapshot.estimates.resize(in.count(sizeof(Estimate)));
  for (Estimate& estimate : snapshot.estimates) {
    for (double& number : estimate) number = in.real();
  }
  if (in.left() > 0) in.fail("goes on behind its end");
  if (!in.ok()) {
    return Error{ErrorCode::kBadInput, "the snapshot " + std::string(in.problem()),
                 "byte " + std::to_string(in.place())};
  }
  return snapshot;
}

}  // namespace cairn
