#pragma once

#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace lorica {

/// What kind of thing went wrong with data from outside. The sentence in Error says the rest.
enum class ErrorCode {
  kNotFound,         ///< a file, joint or device that is not there
  kUnreadable,       ///< there, but could not be read
  kUnwritable,       ///< the output could not be written
  kBadFormat,        ///< malformed text or bytes
  kBadMesh,          ///< a mesh that the algorithms cannot take
  kInvalidArgument,  ///< a setting out of range
  kUnsupported,      ///< understood, but not handled
  kNoDisplay,        ///< no window or no off-screen renderer can be had
  kCancelled,        ///< the caller asked to stop
};

/// A failure caused by data or surroundings: a kind, and one sentence with the numbers in it.
struct Error {
  ErrorCode code;
  std::string message;
};

/// A value, or the reason why there is none. For outside data only; bugs use CHECK.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}
  Result(Error error) : state_(std::move(error)) {}

  [[nodiscard]] bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }
  [[nodiscard]] T& value() & { return std::get<0>(state_); }
  [[nodiscard]] const T& value() const& { return std::get<0>(state_); }
  [[nodiscard]] T&& value() && { return std::get<0>(std::move(state_)); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  [[nodiscard]] const Error& error() const { return std::get<1>(state_); }

 private:
  std::variant<T, Error> state_;
};

/// Success, or the reason for failure.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}
  [[nodiscard]] bool ok() const { return !error_; }
  explicit operator bool() const { return ok(); }
  [[nodiscard]] const Error& error() const { return *error_; }

 private:
  std::optional<Error> error_;
};

}  // namespace lorica

/// Stops the program on a bug of ours, naming where to look. Never in an inner loop.
#define CHECK(condition, message)                                                                       \
  do {                                                                                                  \
    if (!(condition)) {                                                                                 \
      std::fprintf(stderr, "%s:%d: bug in Lorica: %s (%s)\n", __FILE__, __LINE__, message, #condition); \
      std::abort();                                                                                     \
    }                                                                                                   \
  } while (false)
