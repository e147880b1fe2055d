// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string_view>

#include "cairn/core/result.hpp"
#include "cairn/graph/transaction.hpp"
#include "idl/messages.hpp"

/// What a message may hold. Senders are held to it before they send, receivers check again.
namespace cairn::limits {

constexpr std::size_t kName = 64;  ///< bytes of a source, robot or map name
constexpr std::size_t kWord = 64;  ///< bytes of a payload type, an event's kind, a version
constexpr std::size_t kReason = 1024;
constexpr std::size_t kText = 1u << 20;  ///< a command, an event's text, one part of a reply
constexpr std::size_t kTransaction = 16u << 20;  ///< bytes of encode()
constexpr std::size_t kVariables = 10'000;
constexpr std::size_t kFactors = 20'000;
constexpr std::size_t kEdits = 10'000;
constexpr std::size_t kNodesOfFactor = 16;
constexpr std::size_t kNumbersOfFactor = 256;
constexpr std::size_t kPayloadsOfFactor = 16;
constexpr std::size_t kNumbersOfVariable = 7;
constexpr std::size_t kSources = 1024;

/// "source has 70 bytes; expected 1 to 64" and the like.
Result<void> check_name(std::string_view what, std::string_view name);
Result<void> check_count(std::string_view what, std::size_t count, std::size_t most);

/// A transaction that from_wire() would accept after to_wire(). Says nothing about its sense.
Result<void> check(const Transaction& transaction);

/// The same for the bytes of encode(): the middleware drops what is much longer, unanswered.
Result<void> check_size(std::string_view transaction);

/// The first `most` bytes, cut between characters of UTF-8: for texts that may lose their end.
std::string_view cut(std::string_view text, std::size_t most);

}  // namespace cairn::limits
