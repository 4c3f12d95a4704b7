#include "tests/peers/animated.h"

#include "capture/files/bvh_file.h"
#include "capture/files/joint_csv.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <ostream>

namespace lorica::test {
namespace {

Motion clipOf(const CharacterFile& file) {
  Motion motion;
  motion.name = file.clips.front().name;
  motion.bones = framesOf(file.character.skeleton, file.clips.front()).value();
  motion.fromCharacterFile = true;
  return motion;
}

Result<Motion> motionOf(const std::string& name, const std::optional<CharacterFile>& file) {
  if (name.empty()) return clipOf(*file);
  if (name.ends_with(".fbx")) {
    const Result<CharacterFile> read = readCharacterFile(dataset(name));
    if (!read) return read.error();
    return clipOf(*read);
  }
  Motion motion;
  motion.name = name;
  if (name.ends_with(".bvh")) {
    Result<BvhFile> read = readBvh(dataset(name));
    if (!read) return read.error();
    motion.bones = std::move(read->motion);
    return motion;
  }
  Result<std::vector<SkeletonFrame>> joints = readJointCsv(recordingsFolder() / (name + ".csv"));
  if (!joints) return joints.error();
  motion.joints = std::move(*joints);
  return motion;
}

}  // namespace

std::ostream& operator<<(std::ostream& out, const Animated& a) {
  return out << a.name;
}

bool available(const Animated& animated) {
  return *animated.character == '\0' || !dataset(animated.character).empty();
}

std::optional<Performance> performanceOf(const Animated& animated) {
  Performance made;
  if (*animated.character != '\0') {
    Result<CharacterFile> read = readCharacterFile(dataset(animated.character));
    if (!read) {
      ADD_FAILURE() << read.error().message;
      return std::nullopt;
    }
    made.file = std::move(*read);
  }
  made.character = made.file ? made.file->character : makeMannequin();
  const Result<Motion> source = motionOf(animated.motion, made.file);
  EXPECT_TRUE(source.ok()) << source.error().message;
  if (!source) return std::nullopt;
  Result<SkeletalMotion> motion = performedBy(made.character, *source);
  EXPECT_TRUE(motion.ok()) << motion.error().message;
  if (!motion) return std::nullopt;
  made.motion = std::move(*motion);
  return made;
}

Result<void> writeGlb(const std::filesystem::path& out, const Animated& animated, const Performance& performance) {
  if (!performance.file) return writeClip(out, performance.character, performance.motion);
  const Result<std::vector<std::string>> notes =
      writeClip(out, {dataset(animated.character), &*performance.file}, performance.motion);
  if (!notes) return notes.error();
  EXPECT_TRUE(notes->empty());
  return {};
}

}  // namespace lorica::test
