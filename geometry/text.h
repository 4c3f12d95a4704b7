#pragma once

#include <concepts>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace lorica {

/// Converts A-Z to a-z.
[[nodiscard]] std::string lowerCase(std::string_view text);

/// 12345 as "12,345".
[[nodiscard]] std::string groupedDigits(std::string number);
template <std::integral Number>
[[nodiscard]] std::string grouped(Number number) {
  return groupedDigits(std::to_string(number));
}

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

/// What a misspelt name probably meant, for the end of a sentence.
/// Compared by insertions, deletions and changes of letters, and swaps of two neighbours, without regard to case; of
/// equally near names the first one is taken. Names of more than 200 characters and all after the first 2,000 are not
/// compared.
/// @return `; did you mean "hand.l"?`, or empty if more than half of the name would change
[[nodiscard]] std::string didYouMean(std::string_view name, std::span<const std::string> known);

/// Text from files, arguments and devices for messages, as one line: control characters and bytes that are not UTF-8 as
/// \x1b, and the middle of long text replaced by its length. The result is printable and stays as it is.
/// @param longest  [bytes]
[[nodiscard]] std::string printable(std::string_view text, std::size_t longest = 1000);

/// The first or the last bytes of a text, at most `bytes`, cut between characters of UTF-8.
[[nodiscard]] std::string_view firstBytes(std::string_view text, std::size_t bytes);
[[nodiscard]] std::string_view lastBytes(std::string_view text, std::size_t bytes);

/// Whether the bytes of a text file are UTF-16, which Windows calls "Unicode": it is recognised by its byte order mark,
/// or by a zero beside the first letter.
[[nodiscard]] bool isUtf16(std::string_view bytes);

/// A text file's bytes as UTF-8, for every reader of other people's text. UTF-16 is converted, everything else is
/// returned as it is.
[[nodiscard]] std::string asUtf8(std::string bytes);

}  // namespace lorica
