#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cwchar>
#include <locale>
#include <utility>
#include <vector>

namespace lorica {
namespace {

constexpr std::size_t kLongestName = 200;
constexpr std::size_t kMaxCompared = 2000;
constexpr std::size_t kLongestCharacter = 4;  // of UTF-8 [bytes]

[[nodiscard]] std::size_t editDistance(std::string_view a, std::string_view b) {
  const auto small = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  std::vector<std::size_t> row(b.size() + 1);
  std::vector<std::size_t> above(row.size()), twoAbove(row.size());
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  const auto same = [&](std::size_t i, std::size_t j) { return small(a[i - 1]) == small(b[j - 1]); };
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::swap(twoAbove, above);
    std::swap(above, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({above[j - 1] + (same(i, j) ? 0 : 1), above[j] + 1, row[j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && same(i, j - 1) && same(i - 1, j);
      if (swapped) row[j] = std::min(row[j], twoAbove[j - 2] + 1);
    }
  }
  return row.back();
}

bool continues(char c) {
  return (static_cast<unsigned char>(c) & 0xC0) == 0x80;
}

/// Length of the UTF-8 character at the start of the text; 0 if there is none or it is a control character.
std::size_t printableBytes(std::string_view text) {
  const unsigned char first = text[0];
  if (first < 0x80) return first >= 0x20 && first != 0x7F ? 1 : 0;
  const std::size_t length = first >= 0xC2 && first < 0xE0   ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  if (length == 0 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if (!continues(text[i])) return 0;
  }
  const bool control = first == 0xC2 && static_cast<unsigned char>(text[1]) < 0xA0;
  return control ? 0 : length;
}

std::string escaped(std::string_view text) {
  std::string shown;
  shown.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = printableBytes(text);
    if (length > 0) {
      shown += text.substr(0, length);
    } else {
      shown += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[0]));
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return shown;
}

}  // namespace

std::string lowerCase(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  return lower;
}

std::string groupedDigits(std::string number) {
  const int firstDigit = number.starts_with('-') ? 1 : 0;
  for (int at = int(number.size()) - 3; at > firstDigit; at -= 3) number.insert(at, 1, ',');
  return number;
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

std::string didYouMean(std::string_view name, std::span<const std::string> known) {
  if (name.size() > kLongestName) return "";
  const std::string* nearest = nullptr;
  std::size_t min = std::max<std::size_t>(name.size() / 2, 2) + 1;
  for (const std::string& candidate : known.first(std::min(known.size(), kMaxCompared))) {
    if (candidate.size() > kLongestName) continue;
    const std::size_t distance = editDistance(name, candidate);
    if (distance >= min) continue;
    min = distance;
    nearest = &candidate;
  }
  return nearest == nullptr ? "" : fmt::format("; did you mean \"{}\"?", *nearest);
}

std::string printable(std::string_view text, std::size_t longest) {
  if (text.size() <= longest) return escaped(text);
  const std::string_view head = firstBytes(text, 2 * longest / 3), tail = lastBytes(text, longest / 3);
  return fmt::format("{} ... ({} bytes) ... {}", escaped(head), text.size() - head.size() - tail.size(), escaped(tail));
}

std::string_view firstBytes(std::string_view text, std::size_t bytes) {
  if (text.size() <= bytes) return text;
  std::size_t end = bytes;
  while (end > 0 && continues(text[end])) --end;
  return text.substr(0, bytes - end < kLongestCharacter ? end : bytes);  // else it is no UTF-8
}

std::string_view lastBytes(std::string_view text, std::size_t bytes) {
  if (text.size() <= bytes) return text;
  const std::size_t first = text.size() - bytes;
  std::size_t begin = first;
  while (begin < text.size() && continues(text[begin])) ++begin;
  return text.substr(begin - first < kLongestCharacter ? begin : first);
}

bool isUtf16(std::string_view bytes) {
  if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff")) return true;
  return bytes.size() >= 2 && (bytes[0] == '\0') != (bytes[1] == '\0');
}

std::string asUtf8(std::string bytes) {
  if (!isUtf16(bytes)) return bytes;
  const auto byte = [&](std::size_t at) -> unsigned { return static_cast<unsigned char>(bytes[at]); };
  const bool little = byte(0) == 0xff || byte(1) == 0;
  std::u16string units;
  units.reserve(bytes.size() / 2);
  for (std::size_t at = 0; at + 1 < bytes.size(); at += 2) {
    const unsigned unit = little ? byte(at) | byte(at + 1) << 8 : byte(at) << 8 | byte(at + 1);
    if (at > 0 || unit != 0xfeff) units += static_cast<char16_t>(unit);
  }
  constexpr std::size_t kLongest = 3;  // bytes for a unit; a pair of units takes 4
  std::u8string text(kLongest * units.size(), u8'\0');
  std::mbstate_t state{};
  const char16_t* read = nullptr;
  char8_t* end = text.data();
  // Stops at half a pair of units: such a text is cut there.
  (void)std::use_facet<std::codecvt<char16_t, char8_t, std::mbstate_t>>(std::locale::classic())
      .out(state, units.data(), units.data() + units.size(), read, text.data(), text.data() + text.size(), end);
  return {text.data(), end};
}

}  // namespace lorica
