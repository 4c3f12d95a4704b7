#pragma once

#include "geometry/line_scanner.h"
#include "geometry/math.h"
#include "geometry/result.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Internal to the joint streams: rows of fields, whatever divides them.
namespace lorica::joints {

enum class Delimiter : std::uint8_t { kBlanks, kTab, kComma, kSemicolon };

/// What divides the fields of a line.
[[nodiscard]] Delimiter delimiterOf(std::string_view line);

enum class NumberKind : std::uint8_t {
  kNumber,
  kMissing,  ///< an empty field, NaN, infinity
  kBad,
};
/// A decimal comma is understood.
[[nodiscard]] NumberKind readNumber(std::string_view field, double& value);

/// Starts with a letter and is no way to write a missing number.
[[nodiscard]] bool isWord(std::string_view field);
[[nodiscard]] bool sameWord(std::string_view a, std::string_view b);  ///< in any case

/// How far from the sensor a joint may be [m]: beyond it the unit is another one. Low enough that what is set on the
/// floor afterwards stays within what recordings/FORMAT.md allows.
inline constexpr double kLargestCoordinate = 40.0;

/// Walks the rows of a file. Lines that are blank or start with # are passed over; ends of lines may be any.
class RowReader {
 public:
  RowReader(std::string_view text, std::string_view file);

  /// Goes to the next row. @return false at the end of the text
  bool next();
  [[nodiscard]] std::span<const std::string_view> fields() const { return fields_; }
  [[nodiscard]] std::string_view field(std::size_t column) const { return fields_[column]; }
  [[nodiscard]] std::size_t count() const { return fields_.size(); }
  [[nodiscard]] std::size_t line() const { return scanner_.line(); }
  [[nodiscard]] Delimiter delimiter() const { return delimiter_; }

  /// Makes the row have `count` fields where it has them: twice as many between commas are numbers with decimal
  /// commas, and an empty one at the end comes from a delimiter there.
  /// @return false when the row has another number of fields
  [[nodiscard]] bool fit(std::size_t count);
  /// The row is the last one and its line has no end: the recording was cut off while this was written.
  [[nodiscard]] bool cutOff() const;

  /// "walk.csv, line 7: found 12 fields, expected 61 fields (...)".
  [[nodiscard]] Error badCount(std::string_view expected) const;
  /// "walk.csv, line 7, column 12 (neck x): found "abc", expected a number".
  [[nodiscard]] Error badField(std::size_t column, std::string_view name, std::string_view expected) const;
  [[nodiscard]] Error fail(std::string_view foundAndExpected) const;

  /// A number that must be there, of at most `largest`.
  [[nodiscard]] Result<double> number(std::size_t column, std::string_view name, double largest) const;
  /// Three fields times `unit` as a place [m]; nothing when one is missing or all are 0: sensors write both for joints
  /// that they do not see.
  [[nodiscard]] Result<std::optional<Vec3>> place(std::size_t firstColumn, std::string_view name, double unit) const;

  /// Lets the caller put numbers together that a decimal comma tore apart.
  void replaceFields(std::vector<std::string_view> fields) { fields_ = std::move(fields); }

 private:
  void split(std::string_view line);

  LineScanner scanner_;
  std::string file_;
  Delimiter delimiter_ = Delimiter::kComma;
  bool endsWithNewline_ = false;
  bool first_ = true;
  std::vector<std::string_view> fields_;
};

/// Where numbers with decimal commas stand between commas, finds which tokens belong together: of all ways to make
/// `count` numbers the one that looks most like places within 10 m, followed by a unit or zero quaternion where `count`
/// is 7. @return the numbers, each as it stands in the text; nothing when there is no way
[[nodiscard]] std::optional<std::vector<std::string_view>> joinDecimalCommas(std::span<const std::string_view> tokens,
                                                                             std::size_t count);

}  // namespace lorica::joints
