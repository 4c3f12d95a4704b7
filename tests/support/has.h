#pragma once

#include <gtest/gtest.h>

#include <string_view>
#include <vector>

namespace lorica::test {

/// Whether a text holds a part, for EXPECT_TRUE and EXPECT_FALSE, which then show the text.
[[nodiscard]] inline testing::AssertionResult has(std::string_view text, std::string_view part) {
  const bool found = text.find(part) != std::string_view::npos;
  return (found ? testing::AssertionSuccess() : testing::AssertionFailure()) << "`" << part << "` in: " << text;
}

/// Expects each of these parts in a text.
inline void expectAll(std::string_view text, const std::vector<std::string_view>& parts) {
  for (const std::string_view part : parts) EXPECT_TRUE(has(text, part));
}

}  // namespace lorica::test
