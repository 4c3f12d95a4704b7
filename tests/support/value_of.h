#pragma once

#include "geometry/result.h"

#include <gtest/gtest.h>

#include <source_location>
#include <stdexcept>
#include <utility>

namespace lorica::test {

/// The value of a result; a failure fails the test where it is asked for, and ends it.
template <typename T>
[[nodiscard]] T valueOf(Result<T> result, std::source_location where = std::source_location::current()) {
  if (!result.ok()) {
    ADD_FAILURE_AT(where.file_name(), static_cast<int>(where.line())) << result.error().message;
    throw std::runtime_error("the test needs this result");
  }
  return std::move(result).value();
}

}  // namespace lorica::test
