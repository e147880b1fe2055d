// SPDX-License-Identifier: BSD-3-Clause
#include "cairn/core/base64.hpp"

#include <openssl/evp.h>

#include <algorithm>

namespace cairn {
namespace {

constexpr std::size_t kMostBytes = 1u << 30;  // OpenSSL counts in int

const unsigned char* octets(std::string_view text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

}  // namespace

std::string to_base64(std::string_view bytes) {
  std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');  // OpenSSL ends it with a zero
  const int size = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), octets(bytes),
                                   static_cast<int>(bytes.size()));
  text.resize(static_cast<std::size_t>(size));
  return text;
}

Result<std::string> from_base64(std::string_view text) {
  const Error refusal{ErrorCode::kBadInput,
                      "no base64; expected four characters of A-Z a-z 0-9 + / for three bytes, "
                      "the last ones filled up with ="};
  if (text.size() % 4 != 0 || text.size() > kMostBytes) return refusal;
  std::string bytes(text.size() / 4 * 3, '\0');
  const int size = EVP_DecodeBlock(reinterpret_cast<unsigned char*>(bytes.data()), octets(text),
                                   static_cast<int>(text.size()));
  if (size < 0 || static_cast<std::size_t>(size) != bytes.size()) return refusal;
  const auto padding = static_cast<std::size_t>(std::count(text.begin(), text.end(), '='));
  if (padding > 2) return refusal;
  bytes.resize(bytes.size() - padding);
  if (to_base64(bytes) != text) return refusal;  // spaces, bits that are not used
  return bytes;
}

}  // namespace cairn
