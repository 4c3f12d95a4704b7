// Writes the recordings that ship with Lorica: all synthetic motions, two of them also with simulated sensor noise.

#include "capture/files/joint_csv.h"
#include "tests/bench/generators/sensor_noise.h"
#include "tests/bench/generators/synthetic_motion.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace {

int fail(const std::string& sentence) {
  fmt::print(stderr, "make_recordings: {}\n", sentence);
  return 2;
}

}  // namespace

/// Usage: make_recordings OUTDIR. The output is the same on each run.
int main(int argc, char** argv) {
  if (argc != 2) return fail(fmt::format("found {} arguments, expected one folder", argc - 1));
  const std::filesystem::path folder = argv[1];
  std::error_code trouble;
  std::filesystem::create_directories(folder, trouble);
  if (trouble) return fail(fmt::format("cannot create folder {}: {}", folder.string(), trouble.message()));

  for (const std::string_view motion : lorica::kShippedMotions) {
    const auto write = [&](std::vector<lorica::SkeletonFrame> frames, std::string_view suffix) {
      lorica::roundForFile(frames);
      return lorica::writeJointCsv(folder / fmt::format("{}{}.csv", motion, suffix), frames);
    };
    const std::vector<lorica::SkeletonFrame> clean = lorica::synthesizeMotion(motion);
    if (const auto written = write(clean, ""); !written) return fail(written.error().message);
    if (motion != "walk" && motion != "punch_and_kick") continue;
    if (const auto written = write(addSensorNoise(clean, lorica::kSensorNoiseSeed), "_noisy"); !written) {
      return fail(written.error().message);
    }
  }
  return 0;
}
