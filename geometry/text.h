#pragma once

#include <span>
#include <string>
#include <string_view>

namespace lorica {

/// Converts A-Z to a-z.
[[nodiscard]] std::string lowerCase(std::string_view text);

/// 12345 as "12,345".
[[nodiscard]] std::string grouped(long long number);

/// A number, or a count with its noun: "1 part", "12 parts".
[[nodiscard]] std::string counted(long long number, std::string_view noun, std::string_view plural = "");

/// "walk, wave and jump"
[[nodiscard]] std::string listed(std::span<const std::string> names);

/// 0.1234 as "12.3 %".
[[nodiscard]] std::string percent(double fraction);

/// Metres as "1.25 mm".
[[nodiscard]] std::string millimetres(double metres);

/// Microseconds as "85 us", "1.25 ms" or "2.3 s".
[[nodiscard]] std::string duration(double microseconds);

/// The value of an environment variable; empty if it is not set.
[[nodiscard]] std::string environment(const char* name);

}  // namespace lorica
