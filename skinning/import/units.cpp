#include "skinning/import/units.h"

#include <fmt/format.h>

namespace lorica {

namespace {

[[nodiscard]] double factorFor(double metres) {
  if (metres > 1000.0) return 0.001;
  if (metres > 10.0) return 0.01;
  if (metres >= 0.02) return 1.0;
  return metres >= 0.0002 ? 100.0 : 1000.0;
}

}  // namespace

UnitGuess guessUnit(double longestSide, std::optional<double> saidByFile) {
  const double said = saidByFile.value_or(1.0);
  const double metres = longestSide * said;
  const double max = saidByFile ? 100.0 : 10.0;
  if (longestSide <= 0.0 || (metres >= 0.02 && metres <= max)) return {said, ""};
  const double unit = said * factorFor(metres);
  return {unit,
          fmt::format("the bind pose is {:.4g} units long, {:.4g} m in the {}: assuming {:.4g} m per unit, which gives "
                      "{:.4g} m",
                      longestSide, metres, saidByFile ? "file's own unit" : "format's unit", unit, longestSide * unit)};
}

}  // namespace lorica
