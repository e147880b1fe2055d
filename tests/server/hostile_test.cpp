// SPDX-License-Identifier: BSD-3-Clause
// Senders that keep no rule, over the real middleware, against the real service.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <functional>
#include <limits>
#include <thread>

#include "idl/convert.hpp"
#include "idl/dds/endpoint.hpp"
#include "server/dds_transport.hpp"
#include "server/service.hpp"
#include "tests/server/drive.hpp"
#include "tests/support/own_domain.hpp"
#include "tests/support/temporary_folder.hpp"

namespace cairn {
namespace {

using namespace std::chrono_literals;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Writes wire samples as they are and reads receipts.
class RawClient {
 public:
  explicit RawClient(std::uint32_t domain)
      : participant_(*dds::Participant::open(domain, {})),
        writer_(*dds::Writer<cairn_wire_Transaction>::make(participant_, &trouble_)),
        client_state_(*dds::Writer<cairn_wire_Client_state>::make(participant_, &trouble_)),
        states_(*dds::Reader<cairn_wire_Source_state>::make(participant_, &trouble_)),
        reader_(*dds::Reader<cairn_wire_Receipt>::make(participant_, &trouble_)) {
    ClientState state{.source = "mallory", .epoch = 4};
    wire::Arena arena;
    EXPECT_GE(client_state_.write(wire::to_wire(state, 99, arena)), 0);
    for (int i = 0; i < 5000 && state.daemon_ns == 0; ++i) {
      states_.take([&](const cairn_wire_Source_state& sample, const dds_sample_info_t& info) {
        if (info.valid_data) state.daemon_ns = sample.daemon_ns;
      });
      std::this_thread::sleep_for(1ms);
    }
    EXPECT_GE(client_state_.write(wire::to_wire(state, 99, arena)), 0);
  }

  void send(const cairn_wire_Transaction& sample) { ASSERT_GE(writer_.write(sample), 0); }
  [[nodiscard]] bool can_send(const cairn_wire_Transaction& sample) {
    return writer_.write(sample) >= 0;
  }
  /// The next receipt for this sequence; nothing after five seconds.
  std::optional<Receipt> receipt(std::uint64_t sequence) {
    std::optional<Receipt> found;
    for (int i = 0; i < 5000 && !found; ++i) {
      reader_.take([&](const cairn_wire_Receipt& sample, const dds_sample_info_t& info) {
        if (info.valid_data && sample.sequence_number == sequence) found = *wire::from_wire(sample);
      });
      if (!found) std::this_thread::sleep_for(1ms);
    }
    return found;
  }

 private:
  dds::TroubleHandler trouble_;
  dds::Participant participant_;
  dds::Writer<cairn_wire_Transaction> writer_;
  dds::Writer<cairn_wire_Client_state> client_state_;
  dds::Reader<cairn_wire_Source_state> states_;
  dds::Reader<cairn_wire_Receipt> reader_;
};

class Hostile : public testing::Test {
 protected:
  static std::uint32_t domain() { return test::own_domain(); }
  void SetUp() override {
    ASSERT_TRUE(service_.start());
    raw_.emplace(domain());
  }

  // Step `index` of the drive as the raw client's transaction of this sequence.
  static Transaction transaction(std::size_t index, std::uint64_t sequence) {
    Transaction step = test::drive(index + 1)[index];
    step.key = {"mallory", 4, sequence};
    return step;
  }
  using Spoil = std::function<void(cairn_wire_Transaction&)>;
  std::optional<Receipt> send(const Transaction& transaction, const Spoil& spoil = {}) {
    wire::Arena arena;
    cairn_wire_Transaction sample = wire::to_wire(transaction, 99, arena);
    if (spoil) spoil(sample);
    raw_->send(sample);
    return raw_->receipt(transaction.key.sequence);
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<Journal> journal_ = *Journal::open((folder_.path() / "data").string());
  std::unique_ptr<Transport> transport_ = make_dds_transport({.domain = domain()});
  Service service_{*journal_, *transport_, {.solve_after_pause = 20ms}};
  std::optional<RawClient> raw_;
};

struct Attack {
  const char* name;
  RefusalCode code;
  std::function<void(Transaction&)> before;              ///< what the wire carries
  std::function<void(cairn_wire_Transaction&)> after{};  ///< what it cannot
};

std::vector<Attack> attacks() {
  static std::vector<double> million(1'000'000, 0.5);
  return {
      {"NaN", RefusalCode::kNotFinite, [](Transaction& t) { t.variables[0].start[1] = kNan; }},
      {"infinity", RefusalCode::kNotFinite,
       [](Transaction& t) { t.factors[0].numbers[2] = std::numeric_limits<double>::infinity(); }},
      {"indefinite information", RefusalCode::kInformation,
       [](Transaction& t) { t.factors[0].numbers[3] = -1.0; }},
      {"unknown node", RefusalCode::kUnknownVariable,
       [](Transaction& t) { t.factors[0].nodes[0].index = 77; }},
      {"wrong size", RefusalCode::kMalformed,
       [](Transaction& t) { t.factors[0].numbers.pop_back(); }},
      {"unknown type", RefusalCode::kMalformed,
       [](Transaction& t) { t.factors[0].type = FactorType{9999}; }},
      {"self edge", RefusalCode::kMalformed,
       [](Transaction& t) { t.factors[0].nodes[0] = t.factors[0].nodes[1]; }},
      {"no robot", RefusalCode::kMalformed,
       [](Transaction& t) { t.variables[0].node.frame.robot = ""; }},
      {"long name", RefusalCode::kMalformed,
       [](Transaction& t) { t.variables[0].node.frame.robot = std::string(5000, 'x'); }},
      {"too many nodes", RefusalCode::kMalformed,
       [](Transaction& t) { t.factors[0].nodes.resize(17, t.factors[0].nodes[0]); }},
      {"newer version",
       RefusalCode::kVersion,
       {},
       [](cairn_wire_Transaction& w) { w.version = 2; }},
      {"unknown word",
       RefusalCode::kMalformed,
       {},
       [](cairn_wire_Transaction& w) { w.variables._buffer[0].type = 200; }},
      {"a million numbers",
       RefusalCode::kMalformed,
       {},
       [](cairn_wire_Transaction& w) {
         auto& numbers = w.factors._buffer[0].numbers;
         numbers._maximum = numbers._length = static_cast<std::uint32_t>(million.size());
         numbers._buffer = million.data();
       }},
  };
}

TEST_F(Hostile, RefusesForGoodWhatBreaksARuleAndKeepsTheMapAsItWas) {
  std::uint64_t sequence = 0;
  ASSERT_FALSE(send(transaction(0, ++sequence))->refusal);
  const auto state = test::estimates(*journal_);
  for (const Attack& attack : attacks()) {
    SCOPED_TRACE(attack.name);
    Transaction spoiled = transaction(1, ++sequence);
    if (attack.before) attack.before(spoiled);
    const auto refused = send(spoiled, attack.after);
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->refusal, attack.code) << refused->reason;
    EXPECT_FALSE(refused->reason.empty());
    const auto again = send(spoiled, attack.after);
    ASSERT_TRUE(again);
    EXPECT_EQ(again->revision, refused->revision);
    EXPECT_EQ(again->refusal, refused->refusal);
    EXPECT_EQ(send(transaction(1, sequence))->refusal, RefusalCode::kConflict);
  }
  EXPECT_EQ(test::estimates(*journal_), state);
  EXPECT_FALSE(send(transaction(1, ++sequence))->refusal);  // the sequence went on
}

TEST_F(Hostile, DecidesWhatWaitsBehindAnUnreadableOne) {
  wire::Arena arena;
  const Transaction second = transaction(1, 2), first = transaction(0, 1);  // samples point to them
  raw_->send(wire::to_wire(second, 99, arena));
  cairn_wire_Transaction unreadable = wire::to_wire(first, 99, arena);
  unreadable.version = 7;
  raw_->send(unreadable);
  EXPECT_EQ(raw_->receipt(2)->refusal, RefusalCode::kUnknownVariable);
}

TEST_F(Hostile, HearsNothingOfSamplesThatAreLongerThanAnyMessageMayBe) {
  ASSERT_FALSE(send(transaction(0, 1))->refusal);
  Transaction step = transaction(1, 2);
  wire::Arena arena;
  cairn_wire_Transaction huge = wire::to_wire(step, 99, arena);
  std::vector<double> numbers(6'000'000, 0.5);
  huge.factors._buffer[0].numbers._length = static_cast<std::uint32_t>(numbers.size());
  huge.factors._buffer[0].numbers._buffer = numbers.data();
  EXPECT_FALSE(raw_->can_send(huge));  // who has our configuration does not even send it
  EXPECT_FALSE(send(step)->refusal);
}

}  // namespace
}  // namespace cairn
