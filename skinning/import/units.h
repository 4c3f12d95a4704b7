#pragma once

#include <optional>
#include <string>

namespace lorica {

struct UnitGuess {
  double metresPerUnit = 1.0;
  std::string note;  ///< one sentence if the unit was guessed, else empty
};

/// Guesses the length of a file's unit from the size of its character in the bind pose.
///
/// glTF specifies metres, but many files contain centimetres, or were scaled by an extra factor of 100. The longest
/// side of a character is assumed to be 2 cm to 10 m:
/// - above 10 and up to 1,000 units: centimetres; above that: millimetres
/// - below 0.02 and down to 0.0002 units: a unit of 100 m; below that: of 1,000 m
/// - else metres.
/// If the file specifies its unit, sizes up to 100 m are accepted, since they may be intended; beyond that, and below
/// 2 cm, the same rule is applied to the size in the file's unit.
/// @param longestSide   of the bind pose [units of the file]; 0 if unknown
/// @param saidByFile    unit specified by the file [m]
[[nodiscard]] UnitGuess guessUnit(double longestSide, std::optional<double> saidByFile);

}  // namespace lorica
