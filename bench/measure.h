#pragma once

#include "acd/decompose.h"
#include "geometry/result.h"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace lorica::bench {

/// Does work in a process of its own, so that its memory is its own and its end, whatever it is, ends nothing else.
/// Nothing may have used several threads before.
/// @return what the work returned, or its error, or that it crashed
[[nodiscard]] Result<std::string> inOwnProcess(const std::function<Result<std::string>()>& work);

/// Most memory that this process has held at a time, from /proc [MiB].
[[nodiscard]] double peakMemoryMiB();

/// Memory that this process holds and has touched, from /proc [bytes].
[[nodiscard]] double residentBytes();

/// A decomposition with what it cost.
struct Timed {
  Decomposition decomposition;
  double seconds = 0.0;  ///< wall clock, median over the repeats
  double leastSeconds = 0.0;
  double cpuSeconds = 0.0;  ///< over all threads, median
};
[[nodiscard]] Result<Timed> timeDecompose(const TriMesh& mesh, PoseView keyframes, const DecomposeSettings& settings,
                                          int repeats);

[[nodiscard]] double meanOf(std::span<const double> values);
[[nodiscard]] double medianOf(std::vector<double> values);

/// Slope of the least-squares line through (log x, log y): y grows like x to this power.
[[nodiscard]] double fittedExponent(std::span<const double> x, std::span<const double> y);

/// "paper", "fast" or "quality"; the caller has checked the word.
[[nodiscard]] DecomposePreset presetOf(const std::string& name);

/// A field of a CSV row, in quotes where it needs them.
[[nodiscard]] std::string csvField(const std::string& text);

/// Prints an error as a sentence; the exit code: 2.
int fail(const Error& error);

}  // namespace lorica::bench
