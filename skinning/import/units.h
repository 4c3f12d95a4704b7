#pragma once

#include <optional>
#include <string>

namespace lorica {

struct UnitGuess {
  double metresPerUnit = 1.0;
  std::string note;  ///< one sentence where something was guessed, else empty
};

/// How long a file's unit is, from how large its character stands in the bind pose.
///
/// glTF says metres, and yet many files carry centimetres, or were scaled by a hundred once too often. The longest side
/// of a character is taken to be 2 cm to 10 m:
/// - above 10 and up to 1,000 units: centimetres; above that: millimetres
/// - below 0.02 and down to 0.0002 units: a unit of 100 m; below that: of 1,000 m
/// - else metres.
/// Where the file says its unit, that is believed up to 100 m, since those who set it may mean it; beyond, and below
/// 2 cm, the same rule is used on what the file says.
/// @param longestSide   of the bind pose [units of the file]; 0 where there is nothing to go by
/// @param saidByFile    [m]
[[nodiscard]] UnitGuess guessUnit(double longestSide, std::optional<double> saidByFile);

}  // namespace lorica
