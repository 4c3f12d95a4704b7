#include "geometry/text.h"

#include <fmt/format.h>

#include <cstdlib>

namespace lorica {

std::string lowerCase(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  return lower;
}

std::string grouped(long long number) {
  std::string text = std::to_string(number);
  const int firstDigit = number < 0 ? 1 : 0;
  for (int at = int(text.size()) - 3; at > firstDigit; at -= 3) text.insert(at, 1, ',');
  return text;
}

std::string counted(long long number, std::string_view noun, std::string_view plural) {
  if (number == 1) return fmt::format("1 {}", noun);
  return plural.empty() ? fmt::format("{} {}s", grouped(number), noun) : fmt::format("{} {}", grouped(number), plural);
}

std::string listed(std::span<const std::string> names) {
  std::string all;
  for (std::size_t i = 0; i < names.size(); ++i) {
    all += i == 0 ? "" : i + 1 < names.size() ? ", " : " and ";
    all += names[i];
  }
  return all;
}

std::string percent(double fraction) {
  return fmt::format("{:.1f} %", 100.0 * fraction);
}

std::string millimetres(double metres) {
  return fmt::format("{:.2f} mm", 1000.0 * metres);
}

std::string duration(double microseconds) {
  if (microseconds < 999.5) return fmt::format("{:.0f} us", microseconds);
  if (microseconds < 999.5e3) return fmt::format("{:.2f} ms", microseconds * 1e-3);
  return fmt::format("{:.1f} s", microseconds * 1e-6);
}

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string() : std::string(value);
}

}  // namespace lorica
