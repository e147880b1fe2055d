// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cairn/common.h>

#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cairn/core/result.hpp"
#include "idl/convert.hpp"
#include "idl/limits.hpp"

/// For the conversions only: reading what a stranger wrote, and lending what is ours.
namespace cairn::wire {

/// Reads fields of one message and remembers the first that breaks a rule.
class Checks {
 public:
  void version(unsigned found) {
    if (found != kVersion)
      fail("has format version " + std::to_string(found) + ", this Cairn knows version " +
           std::to_string(kVersion) + ": update the older of the two programs");
  }
  std::string name(std::string_view what, const char* value) {
    const std::string_view view = bounded(value, limits::kName);
    keep(limits::check_name(what, view));
    return std::string(view);
  }
  /// Like name(), but may be empty.
  std::string optional_name(std::string_view what, const char* value) {
    return value == nullptr || *value == '\0' ? std::string() : name(what, value);
  }
  std::string text(std::string_view what, const char* value, std::size_t most) {
    const std::string_view view = bounded(value, most);
    if (view.size() > most)
      fail(std::string(what) + " has more than " + std::to_string(most) + " bytes");
    return std::string(view);
  }
  template <class Enum>
  Enum word(std::string_view what, unsigned value, Enum last) {
    if (value > static_cast<unsigned>(last))
      fail(std::string(what) + " is " + std::to_string(value) + "; expected 0 to " +
           std::to_string(static_cast<unsigned>(last)));
    return static_cast<Enum>(value);
  }
  /// False where there are too many to go through.
  bool count(std::string_view what, std::size_t found, std::size_t most) {
    keep(limits::check_count(what, found, most));
    return found <= most;
  }
  template <class Sequence>
  std::vector<double> numbers(std::string_view what, const Sequence& wire, std::size_t most) {
    if (!count(what, wire._length, most)) return {};
    return {wire._buffer, wire._buffer + wire._length};
  }

  void fail(std::string message) {
    if (!error_) error_ = Error{ErrorCode::kBadInput, place_ + std::move(message)};
  }
  void keep(const Result<void>& result) {
    if (!result) fail(result.error().message);
  }
  /// What fails from now on lies in here: "factors[3]: ".
  void enter(std::string_view what, std::size_t index) {
    if (!error_) place_ = std::string(what) + '[' + std::to_string(index) + "]: ";
  }
  void leave() { place_.clear(); }

  [[nodiscard]] bool ok() const { return !error_; }
  template <class T>
  Result<T> result(T value) {
    if (error_) return std::move(*error_);
    return value;
  }

 private:
  // At most one byte more than is allowed: enough to see that it is too long.
  static std::string_view bounded(const char* value, std::size_t most) {
    return value == nullptr ? std::string_view()
                            : std::string_view(value, strnlen(value, most + 1));
  }

  std::optional<Error> error_;
  std::string place_;
};

// The generated structs have no const, dds_write only reads.
inline char* lend(const std::string& text) { return const_cast<char*>(text.c_str()); }

template <class Sequence, class T>
void lend(Sequence& wire, const std::vector<T>& values) {
  wire._maximum = wire._length = static_cast<std::uint32_t>(values.size());
  wire._buffer = const_cast<T*>(values.data());
  wire._release = false;
}

/// An array of `count` in the arena, made the sequence's.
template <class Sequence, class T>
T* make_sequence(Sequence& wire, T*, std::size_t count, Arena& arena) {
  wire._maximum = wire._length = static_cast<std::uint32_t>(count);
  wire._buffer = arena.array<T>(count);
  wire._release = false;
  return wire._buffer;
}
template <class Sequence>
auto* make_sequence(Sequence& wire, std::size_t count, Arena& arena) {
  return make_sequence(wire, wire._buffer, count, arena);
}

/// A copy of the first `most` bytes, where texts may lose their end.
inline char* lend_cut(const std::string& text, std::size_t most, Arena& arena) {
  if (text.size() <= most) return lend(text);
  const std::string_view kept = limits::cut(text, most);
  char* copy = arena.array<char>(kept.size() + 1);
  std::memcpy(copy, kept.data(), kept.size());
  copy[kept.size()] = '\0';
  return copy;
}

inline cairn_wire_Revision to_wire(const Revision& revision) {
  return {.store = revision.store, .era = revision.era, .number = revision.number};
}
inline cairn_wire_EstimateRevisions to_wire(const EstimateRevisions& revisions) {
  return {.graph_revision = to_wire(revisions.graph), .solved_revision = to_wire(revisions.solved)};
}
inline Revision from_wire(const cairn_wire_Revision& wire) {
  return {.store = wire.store, .era = wire.era, .number = wire.number};
}

}  // namespace cairn::wire
