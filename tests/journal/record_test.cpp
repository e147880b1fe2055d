// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/journal/record.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/journal/records.hpp"

namespace cairn {
namespace {

TEST(RecordBytes, OfEveryKindAreReadBackAsTheyWereWritten) {
  ContentHash chain{};
  for (std::uint64_t n = 1; n <= 40; ++n) {
    const std::string bytes = encode_record(n, 3, test::some_record(n), chain);
    const Result<Record> record = decode_record(bytes);
    ASSERT_TRUE(record) << record.error().to_string();
    EXPECT_EQ(record->number, n);
    EXPECT_EQ(record->era, 3u);
    EXPECT_EQ(record->body.index(), test::some_record(n).index());
    EXPECT_EQ(encode_record(n, 3, record->body, chain), bytes);
    EXPECT_EQ(record->chain, chain_after(chain, bytes));
    chain = record->chain;
  }
}

TEST(RecordBytes, HaveAChainThatDependsOnEveryRecordBefore) {
  const ContentHash one = chain_in(encode_record(1, 0, test::some_record(1), {}));
  const ContentHash other = chain_in(encode_record(1, 0, test::some_record(2), {}));
  EXPECT_NE(chain_in(encode_record(2, 0, test::some_record(2), one)),
            chain_in(encode_record(2, 0, test::some_record(2), other)));
}

TEST(RecordBytes, AreRefusedWhenTheyEndAnywhereTooEarly) {
  for (const std::uint64_t n : {1, 5, 9, 13, 17}) {
    const std::string bytes = encode_record(n, 0, test::some_record(n), {});
    for (std::size_t size = 0; size < bytes.size(); ++size)
      ASSERT_FALSE(decode_record(bytes.substr(0, size))) << n << ", " << size;
    EXPECT_FALSE(decode_record(bytes + '\0')) << n;
  }
}

TEST(RecordBytes, ThatWereChangedBreakTheChain) {
  const std::string bytes = encode_record(1, 0, test::some_record(13), {});
  std::mt19937 random(11);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string changed = bytes;
    changed[i] = static_cast<char>(changed[i] ^ (1 << random() % 8));
    EXPECT_NE(chain_after({}, changed), chain_in(changed)) << "byte " << i;
    (void)decode_record(changed);
  }
}

TEST(RecordBytes, OfANewerVersionAreNamedAsSuch) {
  std::string bytes = encode_record(1, 0, test::some_record(1), {});
  bytes[0] = 2;
  const Result<Record> record = decode_record(bytes);
  ASSERT_FALSE(record);
  EXPECT_NE(record.error().message.find("version 2"), std::string::npos);
}

}  // namespace
}  // namespace cairn
