#pragma once

#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <variant>

/// Stops the program on a bug of ours, naming where to look. Never in an inner loop.
#define LORICA_CHECK(condition, message)                                                                \
  do {                                                                                                  \
    if (!(condition)) {                                                                                 \
      std::fprintf(stderr, "%s:%d: bug in Lorica: %s (%s)\n", __FILE__, __LINE__, message, #condition); \
      std::abort();                                                                                     \
    }                                                                                                   \
  } while (false)

/// LORICA_TRY(const Mesh mesh, readMesh(file)): declares `mesh`, or returns the reason for failure from the function
/// around.
#define LORICA_TRY(value, ...) LORICA_TRY_NAMED(LORICA_JOINED(tried_, __LINE__), value, __VA_ARGS__)
/// LORICA_TRY_DO(write(file)): goes on, or returns the reason for failure from the function around.
#define LORICA_TRY_DO(...)                                                        \
  do {                                                                            \
    if (auto tried = (__VA_ARGS__); !tried.ok()) return std::move(tried).error(); \
  } while (false)
#define LORICA_TRY_NAMED(result, value, ...)          \
  auto result = (__VA_ARGS__);                        \
  if (!result.ok()) return std::move(result).error(); \
  value = *std::move(result)
#define LORICA_JOINED(a, b) LORICA_JOINED_AS_THEY_ARE(a, b)
#define LORICA_JOINED_AS_THEY_ARE(a, b) a##b

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
  kNoDisplay,        ///< no window or off-screen renderer is available
  kCancelled,        ///< the caller asked to stop
};

/// A failure caused by data or surroundings: a kind, and one sentence with the numbers in it.
struct Error {
  ErrorCode code;       ///< what kind of failure, for programs
  std::string message;  ///< a sentence for people, with the file and numbers
};

/// A value, or the reason why there is none. Asking for the value of a failure stops the program with the failure's
/// sentence. For outside data only; bugs use LORICA_CHECK.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}      ///< a success
  Result(Error error) : state_(std::move(error)) {}  ///< a failure

  [[nodiscard]] bool ok() const { return state_.index() == 0; }  ///< whether there is a value
  explicit operator bool() const { return ok(); }                ///< the same as ok()
  /// @{
  /// The value; asking for it without checking ok() first ends the program.
  [[nodiscard]] T& value() & {
    checkOk();
    return *std::get_if<0>(&state_);
  }
  [[nodiscard]] const T& value() const& {
    checkOk();
    return *std::get_if<0>(&state_);
  }
  [[nodiscard]] T&& value() && {
    checkOk();
    return std::move(*std::get_if<0>(&state_));
  }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  /// @}
  /// Why there is no value; only if not ok().
  [[nodiscard]] const Error& error() const& {
    LORICA_CHECK(!ok(), "a Result that has a value was asked for its error");
    return *std::get_if<1>(&state_);
  }
  /// Why there is no value; only if not ok().
  [[nodiscard]] Error error() && {
    LORICA_CHECK(!ok(), "a Result that has a value was asked for its error");
    return std::move(*std::get_if<1>(&state_));
  }

 private:
  void checkOk() const {
    if (!ok()) LORICA_CHECK(ok(), error().message.c_str());
  }

  std::variant<T, Error> state_;
};

/// Success, or the reason for failure.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}  ///< a failure
  [[nodiscard]] bool ok() const { return !error_; }  ///< whether it succeeded
  explicit operator bool() const { return ok(); }    ///< the same as ok()
  /// Why it failed; only if not ok().
  [[nodiscard]] const Error& error() const& {
    LORICA_CHECK(!ok(), "a Result that succeeded was asked for its error");
    return *error_;
  }
  /// Why it failed; only if not ok().
  [[nodiscard]] Error error() && {
    LORICA_CHECK(!ok(), "a Result that succeeded was asked for its error");
    return std::move(*error_);
  }

 private:
  std::optional<Error> error_;
};

}  // namespace lorica
