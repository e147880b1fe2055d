// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/core/base64.hpp"

#include <gtest/gtest.h>

namespace cairn {
namespace {

TEST(Base64, IsThatOfTheStandard) {  // RFC 4648, section 10
  const std::pair<const char*, const char*> pairs[] = {{"", ""},
                                                       {"f", "Zg=="},
                                                       {"fo", "Zm8="},
                                                       {"foo", "Zm9v"},
                                                       {"foob", "Zm9vYg=="},
                                                       {"fooba", "Zm9vYmE="},
                                                       {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : pairs) {
    EXPECT_EQ(to_base64(bytes), text);
    EXPECT_EQ(*from_base64(text), bytes);
  }
}

TEST(Base64, KeepsEveryByte) {
  std::string bytes;
  for (int i = 0; i < 1000; ++i) bytes += static_cast<char>(i * 7);
  for (std::size_t size = bytes.size() - 4; size <= bytes.size(); ++size)
    EXPECT_EQ(*from_base64(to_base64(bytes.substr(0, size))), bytes.substr(0, size));
}

TEST(Base64, RefusesWhatItCannotHaveMade) {
  for (const char* text : {"Z", "Zg=", "Zg", "Zh==", "Z===", "====", "Zm9v\n", " Zm9", "Zm9=Zm9v",
                           "Zm9v====", "Zm-v", "\xff\xff\xff\xff"}) {
    const auto bytes = from_base64(text);
    ASSERT_FALSE(bytes) << text;
    EXPECT_EQ(bytes.error().code, ErrorCode::kBadInput);
  }
}

}  // namespace
}  // namespace cairn
