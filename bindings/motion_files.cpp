#include "bindings/motion_files.h"

#include "bindings/file_reading.h"

#include "capture/files/bvh_file.h"
#include "capture/files/joint_csv.h"
#include "capture/files/joint_stream.h"
#include "geometry/errors.h"
#include "prepare/shipped_motion.h"
#include "skinning/import/character_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

Result<Motion> motionByName(const std::string& name) {
  std::vector<std::string_view> names;
  for (int m = 0; m < kSyntheticMotionCount; ++m) {
    const auto which = static_cast<SyntheticMotion>(m);
    if (nameOf(which) == name) return shippedMotion(which);
    names.push_back(nameOf(which));
  }
  return notFound(
      "{}: no such file and no shipped recording with that name, expected a motion (joints, .bvh, .glb, .vrm, .fbx, "
      ".dae) or one of {}",
      name, fmt::join(names, ", "));
}

std::string lowerCased(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

Result<Motion> readClip(const fs::path& file, const std::string& clip) {
  LORICA_TRY(CharacterFile read, readCharacterFile(file, fileReading()));
  const std::string wanted = lowerCased(clip);
  const auto found =
      clip.empty() ? read.clips.begin()
                   : std::ranges::find_if(read.clips, [&](const Clip& own) { return lowerCased(own.name) == wanted; });
  if (found == read.clips.end()) {
    std::vector<std::string> names;
    for (const Clip& own : read.clips) names.push_back(own.name);
    return notFound(names.empty() ? file.string() + ": found no animation, expected at least one clip"
                                  : fmt::format("{}: no clip named {}, expected one of {}", file.string(), clip,
                                                fmt::join(names, ", ")));
  }
  Motion motion;
  motion.name = file.stem().string() + (found->name.empty() ? "" : ": " + found->name);
  LORICA_TRY(motion.bones, prefixed(file.string(), framesOf(read.character.skeleton, *found)));
  motion.fromCharacterFile = true;
  motion.format = read.format;
  return motion;
}

}  // namespace

std::vector<Motion> shippedMotions() {
  std::vector<Motion> motions;
  motions.reserve(kSyntheticMotionCount);
  for (int m = 0; m < kSyntheticMotionCount; ++m) motions.push_back(shippedMotion(static_cast<SyntheticMotion>(m)));
  return motions;
}

Result<Motion> readMotionNamed(const std::string& nameOrFile, const std::string& clip) {
  const fs::path file = nameOrFile;
  std::error_code ignored;
  if (!file.has_parent_path() && !file.has_extension() && !fs::exists(file, ignored)) return motionByName(nameOrFile);
  if (isCharacterFile(file)) return readClip(file, clip);
  if (!clip.empty()) {
    return invalidArgument("{}: clip {} was asked for, but only character files have clips", nameOrFile, clip);
  }
  Motion motion;
  motion.name = file.stem().string();
  if (lowerCased(file.extension().string()) == ".bvh") {
    LORICA_TRY(BvhFile read, readBvh(file));
    motion.bones = std::move(read.motion);
    motion.format = "BVH";
    return motion;
  }
  LORICA_TRY(JointStream read, readJointStream(file));
  motion.joints = std::move(read.frames);
  motion.format = fmt::format("joints ({})", nameOf(read.format));
  return motion;
}

}  // namespace lorica
