// SPDX-License-Identifier: BSD-3-Clause
// Records of version 1 as they were written once. They must be read for ever.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/journal/records.hpp"

namespace cairn {
namespace {

std::string from_hex(const std::string& digits) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2)
    bytes += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  return bytes;
}

TEST(StoredRecords, OfVersionOneAreReadAndContinueTheirChain) {
  std::ifstream file(std::string(CAIRN_SOURCE_DIR) + "/tests/journal/fixtures/records_1.hex");
  ContentHash chain{};
  std::uint64_t number = 0;
  for (std::string line; std::getline(file, line);) {
    const std::string bytes = from_hex(line);
    const Result<Record> record = decode_record(bytes);
    ASSERT_TRUE(record) << record.error().to_string();
    EXPECT_EQ(record->number, ++number);
    EXPECT_EQ(record->kind(), static_cast<RecordKind>(test::some_record(number).index() + 1));
    chain = chain_after(chain, bytes);
    EXPECT_EQ(record->chain, chain);
    EXPECT_EQ(encode_record(number, 0, test::some_record(number),
                            number == 1 ? ContentHash{} : test::some_chain(number - 1).back()),
              bytes);
  }
  EXPECT_EQ(number, 20u);
  EXPECT_EQ(to_string(chain), "a83b4cda14b12c6f31c2fb93df0da0b4220413705f85282bc9d1f774df2359ad");
}

}  // namespace
}  // namespace cairn
