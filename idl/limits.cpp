// SPDX-License-Identifier: BSD-3-Clause
#include "idl/limits.hpp"

#include <string>

namespace cairn::limits {
namespace {

Result<void> check_frame(const OdometryFrame& frame) { return check_name("robot", frame.robot); }

Result<void> check(const NewVariable& variable) {
  if (auto ok = check_frame(variable.node.frame); !ok) return ok;
  if (auto ok = check_count("start", variable.start.size(), kNumbersOfVariable); !ok) return ok;
  return check_count("odometry", variable.odometry.size(), kNumbersOfVariable);
}

Result<void> check(const NewFactor& factor) {
  if (auto ok = check_count("nodes", factor.nodes.size(), kNodesOfFactor); !ok) return ok;
  if (auto ok = check_count("numbers", factor.numbers.size(), kNumbersOfFactor); !ok) return ok;
  if (auto ok = check_count("payloads", factor.payloads.size(), kPayloadsOfFactor); !ok) return ok;
  for (const NodeId& node : factor.nodes)
    if (auto ok = check_frame(node.frame); !ok) return ok;
  return {};
}

Result<void> check(const FactorEdit& edit) {
  return check_name("source of an edited factor", edit.factor.transaction.source);
}

template <class T>
Result<void> check_all(std::string_view what, const std::vector<T>& all, std::size_t most) {
  if (auto ok = check_count(what, all.size(), most); !ok) return ok;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (auto ok = check(all[i]); !ok) {
      Error error = ok.error();
      error.message = std::string(what) + '[' + std::to_string(i) + "]: " + error.message;
      return error;
    }
  }
  return {};
}

}  // namespace

Result<void> check_name(std::string_view what, std::string_view name) {
  if (name.empty() || name.size() > kName)
    return Error{ErrorCode::kBadInput, std::string(what) + " has " + std::to_string(name.size()) +
                                           " bytes; expected 1 to " + std::to_string(kName)};
  if (name.find('\0') != std::string_view::npos)
    return Error{ErrorCode::kBadInput, std::string(what) + " contains a zero byte; expected text"};
  return {};
}

Result<void> check_count(std::string_view what, std::size_t count, std::size_t most) {
  if (count <= most) return {};
  return Error{ErrorCode::kBadInput, std::string(what) + " has " + std::to_string(count) +
                                         " entries; expected at most " + std::to_string(most)};
}

Result<void> check(const Transaction& transaction) {
  if (auto ok = check_name("source", transaction.key.source); !ok) return ok;
  if (auto ok = check_all("variables", transaction.variables, kVariables); !ok) return ok;
  if (auto ok = check_all("factors", transaction.factors, kFactors); !ok) return ok;
  return check_all("edits", transaction.edits, kEdits);
}

Result<void> check_size(std::string_view transaction) {
  if (transaction.size() <= kTransaction) return {};
  return Error{ErrorCode::kBadInput, "the transaction has " + std::to_string(transaction.size()) +
                                         " bytes; expected at most " +
                                         std::to_string(kTransaction) + "; send it in parts"};
}

std::string_view cut(std::string_view text, std::size_t most) {
  if (text.size() <= most) return text;
  while (most > 0 && (static_cast<unsigned char>(text[most]) & 0xC0) == 0x80) --most;
  return text.substr(0, most);
}

}  // namespace cairn::limits
