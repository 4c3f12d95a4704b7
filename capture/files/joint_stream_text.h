#pragma once

#include "geometry/counts.h"
#include "geometry/line_scanner.h"
#include "geometry/result.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Internal to the joint stream readers: rows of fields with any delimiter.
namespace lorica::joints {

enum class Delimiter : std::uint8_t { kBlanks, kTab, kComma, kSemicolon };

/// Detects the delimiter of a line.
[[nodiscard]] Delimiter delimiterOf(std::string_view line);

enum class NumberKind : std::uint8_t {
  kNumber,
  kMissing,  ///< an empty field, NaN, infinity
  kBad,
};
/// Accepts a decimal comma.
[[nodiscard]] NumberKind readNumber(std::string_view field, double& value);

/// Whether a field starts with a letter and does not denote a missing number.
[[nodiscard]] bool isWord(std::string_view field);
[[nodiscard]] bool sameWord(std::string_view a, std::string_view b);  ///< case-insensitive

/// Letters and digits of a name, in lower case: "shoulderleftx" of "Shoulder_Left.X".
[[nodiscard]] std::string plainName(std::string_view name);

/// The first of some words, separated by blanks, for which a test holds; empty if there is none.
template <typename Test>
[[nodiscard]] std::string_view firstWord(std::string_view words, const Test& test) {
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(' '), words.size());
    if (test(words.substr(0, end))) return words.substr(0, end);
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  return {};
}

/// Reads a time of day, with or without a date before it: "2024-05-01T12:30:15.25Z", "00:00:03,4", "1:02:03 PM".
/// @return seconds since 1970, or since midnight if there is no date with the year first
[[nodiscard]] std::optional<double> readClock(std::string_view field);

/// Max distance of a joint from the sensor [m]; beyond it the unit must be different. Low enough that positions stay
/// within the limits of recordings/FORMAT.md after placement on the floor.
inline constexpr double kLargestCoordinate = 40.0;

/// Iterates over the rows of a file. Skips blank lines and lines that start with #; accepts any line endings.
class RowReader {
 public:
  RowReader(std::string_view text, std::string_view file);

  /// Advances to the next row. @return false at the end of the text
  bool next();
  [[nodiscard]] std::span<const std::string_view> fields() const { return fields_; }
  [[nodiscard]] std::string_view field(int column) const { return fields_[column]; }
  [[nodiscard]] int count() const { return countOf(fields_); }
  [[nodiscard]] std::size_t line() const { return scanner_.line(); }
  [[nodiscard]] Delimiter delimiter() const { return delimiter_; }

  /// Adjusts the row to `count` fields if possible: twice as many comma-separated fields are numbers with decimal
  /// commas, an empty last field comes from a trailing delimiter, and tabs at the end of the line are empty fields.
  /// @return false if the row has another number of fields
  [[nodiscard]] bool fit(int count);
  /// Whether the row is the last one and its line has no end: the recording was truncated while writing it.
  [[nodiscard]] bool cutOff() const;

  /// "walk.csv, line 7: found 12 fields, expected 61 fields (...)".
  [[nodiscard]] Error badCount(std::string_view expected) const;
  /// "walk.csv, line 7, column 12 (neck x): found "abc", expected a number".
  [[nodiscard]] Error badField(int column, std::string_view name, std::string_view expected) const;
  [[nodiscard]] Error fail(std::string_view foundAndExpected) const;

  /// Reads a required number of absolute value at most `largest`.
  [[nodiscard]] Result<double> number(int column, std::string_view name, double largest) const;

  /// Lets the caller rejoin numbers that were split at a decimal comma.
  void replaceFields(std::vector<std::string_view> fields) { fields_ = std::move(fields); }

 private:
  void split(std::string_view line);

  LineScanner scanner_;
  std::string file_;
  const char* end_;  ///< of the text
  Delimiter delimiter_ = Delimiter::kComma;
  bool endsWithNewline_ = false;
  bool first_ = true;
  int tabsBehind_ = 0;  ///< the last field of the line
  std::vector<std::string_view> fields_;
};

/// Rejoins numbers with decimal commas that were split at the commas. Of all ways to form `count` numbers, returns the
/// one most similar to positions within 10 m, followed by a unit or zero quaternion if `count` is 7.
/// @return the numbers as in the text; nullopt if there is no way
[[nodiscard]] std::optional<std::vector<std::string_view>> joinDecimalCommas(std::span<const std::string_view> tokens,
                                                                             int count);

}  // namespace lorica::joints
