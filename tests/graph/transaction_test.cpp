// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/graph/transaction.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/support/transactions.hpp"

namespace cairn {
namespace {

std::string hex(std::string_view bytes) {
  std::string text;
  for (const char byte : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02x", static_cast<unsigned char>(byte));
    text += digits;
  }
  return text;
}

TEST(TransactionBytes, AreReadBackAsTheyWereWritten) {
  for (std::uint64_t n = 1; n <= 50; ++n) {
    const std::string bytes = encode(test::some_transaction(n));
    const Result<Transaction> read = decode_transaction(bytes);
    ASSERT_TRUE(read) << read.error().to_string();
    EXPECT_EQ(read->key, test::some_transaction(n).key);
    EXPECT_EQ(read->variables.size(), test::some_transaction(n).variables.size());
    EXPECT_EQ(encode(*read), bytes) << n;
  }
}

TEST(TransactionBytes, AreThoseOfVersionOneForEver) {
  Transaction t{.key = {"s", 2, 3}, .sent_ns = -1, .variables = {}, .factors = {}, .edits = {}};
  const NodeId node{{"r", 4}, 5};
  t.variables.push_back({node, VariableType::kPoint2, {1.0, -2.0}, 6, {}});
  t.factors.push_back({FactorType{7}, FactorKind::kLoop, {node}, {0.5}, {}});
  t.edits.push_back({{{"q", 8, 9}, 10}, FactorChange::kRemove});
  EXPECT_EQ(hex(encode(t)),
            "0100"  // version
            "01000000730200000000000000"
            "0300000000000000"  // key
            "ffffffffffffffff"  // sent_ns
            "01000000"
            "0100000072"
            "0400000000000000"  // frames
            "01000000"          // variables
            "00000000"
            "0500000000000000"
            "02"
            "0600000000000000"  //   node, type, stamp
            "02000000"
            "000000000000f03f"
            "00000000000000c0"
            "00000000"  // start, odometry
            "01000000"  // factors
            "0700"
            "01"
            "01000000"
            "00000000"
            "0500000000000000"  //   type, kind, nodes
            "01000000"
            "000000000000e03f"
            "00000000"  //   numbers, payloads
            "01000000"  // edits
            "0100000071"
            "0800000000000000"
            "0900000000000000"
            "0a000000"
            "02");
}

TEST(TransactionBytes, KeepEveryBitOfANumber) {
  Transaction t = test::some_transaction(1);
  t.factors[0].numbers = {-0.0, std::numeric_limits<double>::quiet_NaN(),
                          std::numeric_limits<double>::denorm_min()};
  const Result<Transaction> read = decode_transaction(encode(t));
  ASSERT_TRUE(read);
  EXPECT_EQ(encode(*read), encode(t));
}

TEST(TransactionBytes, AreRefusedWhenTheyEndAnywhereTooEarly) {
  const std::string bytes = encode(test::some_transaction(3));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Result<Transaction> read = decode_transaction(bytes.substr(0, size));
    ASSERT_FALSE(read) << size;
    EXPECT_NE(read.error().place.find("byte "), std::string::npos);
  }
  EXPECT_FALSE(decode_transaction(bytes + '\0'));
}

TEST(TransactionBytes, ThatWereChangedAreRefusedOrMeanSomethingElse) {
  const std::string bytes = encode(test::some_transaction(4));
  std::mt19937 random(7);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string changed = bytes;
    changed[i] = static_cast<char>(changed[i] ^ (1 << random() % 8));
    const Result<Transaction> read = decode_transaction(changed);
    // One meaning, one string: what is accepted encodes to itself.
    if (read) {
      EXPECT_EQ(encode(*read), changed) << "byte " << i;
    }
  }
}

TEST(TransactionBytes, WithHugeCountsAreRefusedBeforeAnythingIsAllocated) {
  std::string bytes = encode(test::some_transaction(1));
  for (std::size_t i = 0; i + 4 <= bytes.size(); ++i) {
    std::string changed = bytes;
    changed.replace(i, 4, "\xff\xff\xff\xff");
    (void)decode_transaction(changed);
  }
}

TEST(TransactionBytes, OfANewerVersionAreNamedAsSuch) {
  std::string bytes = encode(test::some_transaction(1));
  bytes[0] = 2;
  const Result<Transaction> read = decode_transaction(bytes);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("version 2"), std::string::npos);
}

TEST(TransactionBytes, WithNamesThatAreEmptyOrTooLongAreRefused) {
  Transaction t = test::some_transaction(1);
  t.key.source = "";
  EXPECT_FALSE(decode_transaction(encode(t)));
  t.key.source = std::string(64, 's');
  EXPECT_TRUE(decode_transaction(encode(t)));
  t.key.source += 's';
  EXPECT_FALSE(decode_transaction(encode(t)));
}

TEST(Revision, IsWrittenAsStoreEraNumber) {
  EXPECT_EQ(to_string(Revision{0x8f3a, 2, 1234}), "0000000000008f3a:2:1234");
}

}  // namespace
}  // namespace cairn
