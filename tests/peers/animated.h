#pragma once

#include "session/prepare/motion.h"
#include "skinning/clip_files/character_clip.h"

#include <iosfwd>
#include <optional>
#include <string>

namespace lorica::test {

/// Somebody's character and a motion for it.
struct Animated {
  const char* name;
  const char* character;  ///< below the data; empty = the mannequin
  const char* motion;     ///< below the data, or the name of a recording; empty = the character's first clip

  friend std::ostream& operator<<(std::ostream& out, const Animated& a);
};

/// Every shared character, and each kind of motion.
inline constexpr Animated kAnimated[] = {
    {"mannequin", "", "walk"},
    {"cesiumman", "characters/cesiumman/CesiumMan.glb", "walk"},
    {"cesiumman_bvh", "characters/cesiumman/CesiumMan.glb", "bvh/animated_drawings/zombie.bvh"},
    {"godette", "characters/godette/Godette_vrm_v4.vrm", "punch_and_kick"},
    {"greenman", "characters/greenman/greenman.glb", "walk"},
    {"barbarian", "characters/kaykit/Barbarian.glb", "walk"},
    {"mage", "characters/kaykit/Mage.glb", "squat_and_reach"},
    {"robot", "characters/raylib_robot/robot.glb", "walk"},
    {"arnaud", "characters/arnaud/arnaud.fbx", "walk"},
    {"arnaud_fbx", "characters/arnaud/arnaud.fbx", "characters/arnaud/run.fbx"},
    {"fox", "characters/fox/Fox.glb", ""},
};

/// Whether the third-party files are there.
[[nodiscard]] bool available(const Animated& animated);

/// A character in motion.
struct Performance {
  std::optional<CharacterFile> file;  ///< none of the mannequin
  Character character;
  SkeletalMotion motion;

  /// Whether its .glb is the file with one animation more.
  [[nodiscard]] bool keepsFile() const { return file && file->format != "FBX"; }
};

/// Fails the test, and returns nothing, if the files cannot be read or the character cannot perform.
[[nodiscard]] std::optional<Performance> performanceOf(const Animated& animated);

/// The .glb of a performance.
[[nodiscard]] Result<void> writeGlb(const std::filesystem::path& out, const Animated& animated,
                                    const Performance& performance);

}  // namespace lorica::test
