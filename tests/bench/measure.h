#pragma once

#include "acd/decompose.h"
#include "geometry/result.h"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace lorica::bench {

/// Runs work in its own process, to measure its memory separately and to survive its crashes. The calling process must
/// not have started threads before.
/// @return the result of the work, its error, or an error if it crashed
[[nodiscard]] Result<std::string> inOwnProcess(const std::function<Result<std::string>()>& work);

/// Peak memory of this process, from /proc [MiB].
[[nodiscard]] double peakMemoryMiB();

/// Resident memory of this process, from /proc [bytes].
[[nodiscard]] double residentBytes();

/// CPU time so far of this process, over all threads, or of this thread: other load of the machine does not count [s].
[[nodiscard]] double cpuSeconds();
[[nodiscard]] double threadSeconds();

/// A decomposition with its costs.
struct Timed {
  Decomposition decomposition;
  double seconds = 0.0;  ///< wall clock, median of the repeats
  double minSeconds = 0.0;
  double cpuSeconds = 0.0;  ///< over all threads, median
};
[[nodiscard]] Result<Timed> timeDecompose(const TriMesh& mesh, PoseView keyframes, const DecomposeSettings& settings,
                                          int repeats);

[[nodiscard]] double meanOf(std::span<const double> values);
[[nodiscard]] double medianOf(std::vector<double> values);
/// The value below which a share of all values lies, 0 to 1; 0 if there are none.
[[nodiscard]] double atRank(std::vector<double> values, double share);

/// Slope of the least-squares line through (log x, log y): y is proportional to x to this power.
[[nodiscard]] double fittedExponent(std::span<const double> x, std::span<const double> y);

/// @param name  "paper", "fast" or "quality", validated by the caller
[[nodiscard]] DecomposePreset presetOf(const std::string& name);

/// A field of a CSV row, quoted if necessary.
[[nodiscard]] std::string csvField(const std::string& text);

/// --instructions SET: the vector kernels do without what is newer than a set, such as AVX2 on a machine with AVX-512.
void addInstructions(CLI::App& app);

/// Prints an error message. @return exit code 2
int fail(const Error& error);

}  // namespace lorica::bench
