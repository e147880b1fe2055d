// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/core/content_hash.hpp"

#include <gtest/gtest.h>

namespace cairn {
namespace {

// FIPS 180-2, appendix B.
TEST(ContentHash, IsSha256) {
  EXPECT_EQ(to_string(content_hash("")),
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(to_string(content_hash("abc")),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace cairn
