#pragma once

#include "export/rigid_model.h"
#include "prepare/cover_poses.h"
#include "skinning/clip_files/character_document.h"
#include "tests/peers/animated.h"
#include "tests/peers/peer.h"

#include <optional>
#include <string>
#include <vector>

namespace lorica::test {

/// The characters whose exports are tested.
inline constexpr Animated kExported[] = {
    {"mannequin", "", "walk"},
    {"cesiumman", "characters/cesiumman/CesiumMan.glb", "walk"},
    {"godette", "characters/godette/Godette_vrm_v4.vrm", "punch_and_kick"},
    {"arnaud", "characters/arnaud/arnaud.fbx", "walk"},
};

/// A character with a rigid hull of 32 vertices for each bone.
struct Exported {
  Animated animated;
  std::optional<CharacterFile> file;
  Character character;
  SkeletalMotion motion;
  CoverPoses poses;
  std::vector<RigidCollider> colliders;
  RigidModel model;
};

/// Makes it. Fails the test, and returns none, if that fails.
[[nodiscard]] std::optional<Exported> exported(const Animated& animated);

/// Its file with nothing added, or what a file of it would hold.
[[nodiscard]] CharacterDocument documentOf(const Exported& made);

/// Names of its hulls, in their order.
[[nodiscard]] std::vector<std::string> namesOf(const Exported& made);

/// Makes the character of a parametrised test, or skips the test with the reason.
#define LORICA_REQUIRE_EXPORT(name)                                                                 \
  LORICA_REQUIRE_PEERS();                                                                           \
  if (!::lorica::test::available(GetParam())) GTEST_SKIP() << GetParam().character << " is absent"; \
  const std::optional<::lorica::test::Exported> name = ::lorica::test::exported(GetParam());        \
  ASSERT_TRUE(name)

}  // namespace lorica::test
