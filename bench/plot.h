#pragma once

#include "geometry/result.h"

#include <filesystem>
#include <string>
#include <vector>

namespace lorica::bench {

/// One line or set of bars in a chart.
struct Series {
  std::string name;  ///< for the legend
  std::vector<double> x;
  std::vector<double> y;
  bool dots = false;  ///< draw a dot at each point
};

/// A chart with axes, ticks and a legend, drawn as a PNG.
struct Chart {
  std::string title;
  std::string xName;
  std::string yName;
  std::vector<Series> series;
  bool logX = false;                    ///< logarithmic, with ticks at the values of x that occur
  bool bars = false;                    ///< bars of equal width, side by side, instead of lines
  std::vector<std::string> ticks = {};  ///< labels instead of numbers, one for each x of the first series
};

/// Writes one or more charts, one below the other, as one picture of 1000 pixels width.
[[nodiscard]] Result<void> writeCharts(const std::filesystem::path& file, const std::vector<Chart>& charts);

/// A histogram of several sets of values with common bins, as bars: x is the centre of a bin, y the share of values.
[[nodiscard]] Chart histogram(const std::vector<Series>& values, int bins);

}  // namespace lorica::bench
