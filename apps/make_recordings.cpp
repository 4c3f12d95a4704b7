// Writes the recordings that ship with Lorica: all synthetic motions, two of them also with simulated sensor noise.

#include "apps/standard_streams.h"
#include "capture/files/joint_csv.h"
#include "capture/synthetic/synthetic_motion.h"
#include "geometry/printable.h"

#include <fmt/core.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

namespace {

constexpr int kTrouble = 2;
constexpr std::string_view kUsage =
    "Usage: lorica-make-recordings OUTDIR\n"
    "Writes the recordings that ship with Lorica into OUTDIR as joint CSV (recordings/FORMAT.md).\n"
    "The output is the same on each run.\n";

int fail(std::string_view sentence) {
  lorica::say(fmt::format("lorica-make-recordings: {}\n", lorica::printable(sentence)));
  return kTrouble;
}

}  // namespace

int main(int argc, char** argv) {
  using lorica::SyntheticMotion;
  lorica::openStandardStreams();
  if (argc == 2 && (std::string_view(argv[1]) == "--help" || std::string_view(argv[1]) == "-h")) {
    const lorica::Result<void> printed = lorica::print(kUsage, "the help");
    return printed ? 0 : fail(printed.error().message);
  }
  if (argc != 2) return fail(fmt::format("found {} arguments, expected one folder; see --help", argc - 1));
  if (argv[1][0] == '-' || argv[1][0] == '\0') {
    return fail(fmt::format("found \"{}\", expected a folder; see --help", argv[1]));
  }
  const std::filesystem::path folder = argv[1];
  std::error_code trouble;
  std::filesystem::create_directories(folder, trouble);
  if (trouble) return fail(fmt::format("cannot create folder {}: {}", folder.string(), trouble.message()));

  for (int i = 0; i < lorica::kSyntheticMotionCount; ++i) {
    const auto motion = static_cast<SyntheticMotion>(i);
    const auto write = [&](std::vector<lorica::SkeletonFrame> frames, std::string_view suffix) {
      lorica::roundForFile(frames);
      return lorica::writeJointCsv(folder / fmt::format("{}{}.csv", nameOf(motion), suffix), frames);
    };
    const std::vector<lorica::SkeletonFrame> clean = synthesizeMotion(motion);
    if (const auto written = write(clean, ""); !written) return fail(written.error().message);
    if (motion != SyntheticMotion::kWalk && motion != SyntheticMotion::kPunchAndKick) continue;
    if (const auto written = write(addSensorNoise(clean, lorica::kSensorNoiseSeed), "_noisy"); !written) {
      return fail(written.error().message);
    }
  }
  return 0;
}
