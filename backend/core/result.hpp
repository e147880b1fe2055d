// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "cairn/core/check.hpp"

namespace cairn {

/// What went wrong, in the terms of the command line's exit codes.
enum class ErrorCode {
  kInternal = 1,     ///< a bug or an exhausted machine
  kUsage = 2,        ///< the caller asked for something that does not exist
  kBadInput = 3,     ///< a file or message breaks its format
  kNotUsable = 4,    ///< solved, but the result must not be used
  kUnreachable = 5,  ///< the daemon does not answer
};

/// An error with its place ("intel.g2o:312:9", or the sender), what was expected, and what to do.
struct Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string message;
  std::string place{};

  /// "place: message", or just the message where there is no place.
  [[nodiscard]] std::string to_string() const {
    return place.empty() ? message : place + ": " + message;
  }
};

/// A value or the Error that prevented it. Check before reading: reading the wrong side aborts.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value)
      : state_(std::in_place_index<0>, std::move(value)) {}  // NOLINT(google-explicit-constructor)
  Result(Error error)
      : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }

  [[nodiscard]] T& value() & { return checked_value(); }
  [[nodiscard]] const T& value() const& { return const_cast<Result*>(this)->checked_value(); }
  [[nodiscard]] T&& value() && { return std::move(checked_value()); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  [[nodiscard]] const Error& error() const {
    CAIRN_CHECK(!ok(), "error() of a Result that holds a value");
    return std::get<1>(state_);
  }

 private:
  T& checked_value() {
    CAIRN_CHECK(ok(), "value() of a Result that holds an error");
    return std::get<0>(state_);
  }

  std::variant<T, Error> state_;
};

/// Success, or the Error that prevented it.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const { return !error_.has_value(); }
  explicit operator bool() const { return ok(); }
  [[nodiscard]] const Error& error() const {
    CAIRN_CHECK(!ok(), "error() of a Result that holds a success");
    return *error_;
  }

 private:
  std::optional<Error> error_;
};

}  // namespace cairn
