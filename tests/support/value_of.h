#pragma once

#include "geometry/result.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <utility>

namespace lorica::test {

/// The value of a result; a failure fails the test where it is asked for, and ends it. clang 14 has the builtins of
/// std::source_location's values, but not that class.
template <typename T>
[[nodiscard]] T valueOf(Result<T> result, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  if (!result.ok()) {
    ADD_FAILURE_AT(file, line) << result.error().message;
    throw std::runtime_error("the test needs this result");
  }
  return std::move(result).value();
}

/// The error of a result; a success fails the test where it is asked for, and ends it.
template <typename T>
[[nodiscard]] Error errorOf(const Result<T>& result, const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
  if (result.ok()) {
    ADD_FAILURE_AT(file, line) << "expected an error";
    throw std::runtime_error("the test needs this error");
  }
  return result.error();
}

}  // namespace lorica::test
