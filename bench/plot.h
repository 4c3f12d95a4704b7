#pragma once

#include "geometry/result.h"

#include <filesystem>
#include <string>
#include <vector>

namespace lorica::bench {

/// One line or set of bars in a chart.
struct Series {
  std::string name;  ///< in the legend
  std::vector<double> x;
  std::vector<double> y;
  bool dots = false;  ///< a dot at each point
};

/// A chart with axes, ticks and a legend, drawn as a PNG.
struct Chart {
  std::string title;
  std::string xName;
  std::string yName;
  std::vector<Series> series;
  bool logX = false;                    ///< ticks at the values of x that occur
  bool bars = false;                    ///< bars of one common width, side by side, instead of lines
  std::vector<std::string> ticks = {};  ///< in place of numbers, one for each x of the first series
};

/// Writes a chart, or several below one another, as one picture of 1000 pixels in width.
[[nodiscard]] Result<void> writeCharts(const std::filesystem::path& file, const std::vector<Chart>& charts);

/// A histogram of several sets of values over common bins, as bars: x is the middle of a bin, y the share of values.
[[nodiscard]] Chart histogram(const std::vector<Series>& values, int bins);

}  // namespace lorica::bench
