#pragma once

#include <gtest/gtest.h>

#include <tuple>
#include <vector>

namespace lorica::test {

/// Checks that two objects have the same values in these fields.
template <class T, class... Fields>
void expectSame(const T& a, const T& b, Fields T::*... fields) {
  EXPECT_EQ(std::tie(a.*fields...), std::tie(b.*fields...));
}

/// Checks that the elements of two lists have the same values in these fields.
template <class T, class... Fields>
void expectSame(const std::vector<T>& a, const std::vector<T>& b, Fields T::*... fields) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    SCOPED_TRACE(i);
    expectSame(a[i], b[i], fields...);
  }
}

}  // namespace lorica::test
