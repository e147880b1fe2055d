// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/factors/factor_codec.hpp"

#include <array>
#include <cmath>

#include "cairn/factors/altitude.hpp"
#include "cairn/factors/bearing.hpp"
#include "cairn/factors/between.hpp"
#include "cairn/factors/between_offset.hpp"
#include "cairn/factors/gnss.hpp"
#include "cairn/factors/gravity.hpp"
#include "cairn/factors/landmark_xy.hpp"
#include "cairn/factors/landmark_xyz.hpp"
#include "cairn/factors/number_row.hpp"
#include "cairn/factors/prior.hpp"
#include "cairn/factors/range.hpp"
#include "cairn/factors/range_bearing.hpp"
#include "cairn/factors/yaw.hpp"

namespace cairn {
namespace {

// The members of each type in the order of its numbers; the information follows.
void visit(auto& f, auto&& field)
  requires requires { f.T_a_b_measured; }
{
  field(f.T_a_b_measured);
}
void visit(auto& f, auto&& field)
  requires requires { f.T_sensor_a_sensor_b_measured; }
{
  field(f.T_sensor_a_sensor_b_measured), field(f.sensor_a), field(f.sensor_b);
}
void visit(auto& f, auto&& field)
  requires requires { f.T_map_body_measured; }
{
  field(f.T_map_body_measured);
}
void visit(auto& f, auto&& field)
  requires requires { f.T_map_sensor_measured; }
{
  field(f.T_map_sensor_measured), field(f.sensor);
}
void visit(auto& f, auto&& field)
  requires requires { f.p_map_measured; }
{
  field(f.p_map_measured);
}
void visit(auto& f, auto&& field)
  requires requires { f.p_sensor_measured; }
{
  field(f.p_sensor_measured), field(f.sensor);
}
void visit(auto& f, auto&& field)
  requires requires { f.p_map_antenna_measured; }
{
  field(f.p_body_antenna), field(f.p_map_antenna_measured);
}
void visit(auto& f, auto&& field)
  requires requires { f.z_map_m_measured; }
{
  field(f.z_map_m_measured);
}
void visit(auto& f, auto&& field)
  requires requires { f.yaw_rad_measured; }
{
  field(f.yaw_rad_measured);
}
void visit(auto& f, auto&& field)
  requires requires { f.down_body_measured; }
{
  field(f.down_body_measured);
}
void visit(auto& f, auto&& field)
  requires requires { f.range_m_measured; }
{
  field(f.range_m_measured);
  if constexpr (requires { f.bearing_rad_measured; }) field(f.bearing_rad_measured);
  if constexpr (requires { f.azimuth_rad_measured; })
    field(f.azimuth_rad_measured), field(f.elevation_rad_measured);
}
void visit(auto& f, auto&& field)
  requires(
      requires { f.bearing_rad_measured; } && !requires { f.range_m_measured; })
{
  field(f.bearing_rad_measured);
}

template <class F>
std::vector<double> numbers_of(F& factor) {
  std::vector<double> numbers;
  visit(factor, NumberWriter{numbers});
  for (int row = 0; row < F::kDimension; ++row) {
    for (int column = row; column < F::kDimension; ++column)
      numbers.push_back(factor.information(row, column));
  }
  return numbers;
}

// False where a quaternion is not of unit length.
template <class F>
bool read_numbers(const std::vector<double>& numbers, F& factor) {
  NumberReader reader{numbers.data()};
  visit(factor, reader);
  for (int row = 0; row < F::kDimension; ++row) {
    for (int column = row; column < F::kDimension; ++column)
      factor.information(row, column) = factor.information(column, row) = *reader.next++;
  }
  return reader.unit_quaternions;
}

struct Codec {
  FactorTypeInfo info;
  std::optional<FactorFault> (*find_fault)(const NewFactor& factor);
  bool (*describe)(const FactorBatch& batch, std::size_t index, NewFactor& out);
  Result<FactorRef> (*add)(Graph& graph, const NewFactor& factor, std::span<const VariableId> ids);
};

// Positions of GNSS are in the frame at a datum: latitude, longitude and height end the numbers.
constexpr std::size_t kDatumNumbers = 3;

Geodetic last_three(const std::vector<double>& numbers) {
  const double* datum = numbers.data() + numbers.size() - kDatumNumbers;
  return {datum[0], datum[1], datum[2]};
}

template <class F>
Codec codec(std::uint16_t number) {
  F zero{};
  zero.information.setZero();
  return {{static_cast<FactorType>(number),
           F::kName,
           {F::Variables::kArray.begin(), F::Variables::kArray.end()},
           numbers_of(zero).size()},
          [](const NewFactor& factor) -> std::optional<FactorFault> {
            F read{};
            if (!read_numbers(factor.numbers, read))
              return FactorFault{RefusalCode::kMalformed, kNotUnit};
            if (!is_positive_semidefinite<F::kDimension>(read.information)) {
              return FactorFault{
                  RefusalCode::kInformation,
                  "the information of " + std::string(F::kName) + " is not positive semidefinite"};
            }
            return std::nullopt;
          },
          [](const FactorBatch& batch, std::size_t index, NewFactor& out) {
            const auto* typed = dynamic_cast<const TypedBatch<F>*>(&batch);
            if (typed == nullptr) return false;
            const F& factor = typed->factor(index);
            out.numbers = numbers_of(factor);
            return true;
          },
          [](Graph& graph, const NewFactor& factor, std::span<const VariableId> ids) {
            F read{};
            read_numbers(factor.numbers, read);
            std::array<VariableId, F::Variables::kArity> named;
            std::copy_n(ids.begin(), named.size(), named.begin());
            return graph.add_factor(read, named, factor.kind);
          }};
}

// As F, at a datum. A graph holds both alike.
template <class F>
Codec at_datum(std::uint16_t number, std::string_view name) {
  Codec as = codec<F>(number);
  as.info.name = name;
  as.info.numbers += kDatumNumbers;
  as.info.at_datum = true;
  as.describe = [](const FactorBatch&, std::size_t, NewFactor&) { return false; };
  return as;
}

const std::vector<Codec>& codecs() {
  static const std::vector<Codec> all{
      codec<BetweenSe2>(1),
      codec<BetweenSe3>(2),
      codec<PriorSe2>(3),
      codec<PriorSe3>(4),
      codec<PriorXy>(5),
      codec<LandmarkXy>(6),
      codec<LandmarkXyz>(7),
      codec<BetweenOffsetSe2>(8),
      codec<BetweenOffsetSe3>(9),
      codec<BearingXy>(10),
      codec<RangeXy>(11),
      codec<RangeXyz>(12),
      codec<RangeBearingXy>(13),
      codec<RangeBearingXyz>(14),
      codec<GnssSe2>(15),
      codec<GnssSe3>(16),
      codec<Altitude>(17),
      codec<YawSe2>(18),
      codec<YawSe3>(19),
      codec<Gravity>(20),
      at_datum<GnssSe2>(21, "gnss_se2_at_datum"),
      at_datum<GnssSe3>(22, "gnss_se3_at_datum"),
  };
  return all;
}

const Codec* find_codec(FactorType type) {
  const auto number = static_cast<std::size_t>(type);
  return number >= 1 && number <= codecs().size() ? &codecs()[number - 1] : nullptr;
}

}  // namespace

std::span<const FactorTypeInfo> factor_types() {
  static const std::vector<FactorTypeInfo> infos = [] {
    std::vector<FactorTypeInfo> all;
    for (const Codec& codec : codecs()) all.push_back(codec.info);
    return all;
  }();
  return infos;
}

const FactorTypeInfo* find_factor_type(FactorType type) {
  const Codec* codec = find_codec(type);
  return codec == nullptr ? nullptr : &codec->info;
}

bool is_gated(FactorType type, FactorKind kind) {
  const std::vector<VariableType>& signature = find_factor_type(type)->signature;
  return kind == FactorKind::kLoop && signature.size() == 2 && is_pose(signature[0]) &&
         is_pose(signature[1]);
}

NewFactor describe_factor(const Graph& graph, FactorRef ref) {
  const FactorBatch& batch = *graph.batches()[ref.batch];
  NewFactor factor;
  factor.kind = batch.kinds()[ref.index];
  for (const Codec& codec : codecs()) {
    if (codec.info.name != batch.type_name() || !codec.describe(batch, ref.index, factor)) continue;
    factor.type = codec.info.type;
    return factor;
  }
  CAIRN_CHECK(false, "a factor type without a codec");
  return factor;
}

std::optional<FactorFault> find_fault(const NewFactor& factor) {
  const Codec* codec = find_codec(factor.type);
  if (codec == nullptr) {
    return FactorFault{RefusalCode::kMalformed,
                       "factor type " + std::to_string(static_cast<int>(factor.type)) +
                           " is not known; known are 1 to " + std::to_string(codecs().size())};
  }
  const std::string name(codec->info.name);
  const std::size_t arity = codec->info.signature.size();
  if (factor.nodes.size() != arity)
    return FactorFault{RefusalCode::kMalformed,
                       count_fault(name, arity, "nodes", factor.nodes.size())};
  if (factor.numbers.size() != codec->info.numbers) {
    return FactorFault{RefusalCode::kMalformed,
                       count_fault(name, codec->info.numbers, "numbers", factor.numbers.size())};
  }
  if (!all_finite(factor.numbers)) return not_finite(name);
  for (std::size_t k = 0; k < factor.nodes.size(); ++k) {
    for (std::size_t l = 0; l < k; ++l) {
      if (factor.nodes[k] == factor.nodes[l]) {
        return FactorFault{RefusalCode::kMalformed,
                           name + " ties " + to_string(factor.nodes[k]) + " to itself"};
      }
    }
  }
  if (codec->info.at_datum && !is_place(last_three(factor.numbers)))
    return FactorFault{RefusalCode::kMalformed,
                       name + " has a datum that is no latitude, longitude and height (deg, m)"};
  return codec->find_fault(factor);
}

std::optional<Geodetic> datum_of(const NewFactor& factor) {
  const Codec* codec = find_codec(factor.type);
  if (codec == nullptr || !codec->info.at_datum) return std::nullopt;
  return last_three(factor.numbers);
}

bool set_datum(NewFactor& factor, const Geodetic& datum) {
  const FactorTypeInfo* without = find_factor_type(factor.type);
  for (const FactorTypeInfo& with : factor_types()) {
    if (without == nullptr || !with.at_datum ||
        with.name != std::string(without->name) + "_at_datum")
      continue;
    factor.type = with.type;
    factor.numbers.insert(factor.numbers.end(),
                          {datum.latitude_deg, datum.longitude_deg, datum.height_m});
    return true;
  }
  return false;
}

Result<FactorRef> add_factor(Graph& graph, const NewFactor& factor,
                             std::span<const VariableId> ids) {
  return find_codec(factor.type)->add(graph, factor, ids);
}

}  // namespace cairn
