#include "tests/peers/exported.h"

#include "export/mesh_export.h"
#include "skinning/body/closed_body.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

constexpr int kVertices = 32;  // of a hull

/// The whole mesh as one part: hulls for each bone do not use parts.
Decomposition undivided(const Character& character) {
  Decomposition one;
  one.vertexCount = static_cast<int>(character.mesh.vertices.size());
  one.triangleCount = static_cast<int>(character.mesh.triangles.size());
  return one;
}

}  // namespace

std::optional<Exported> exported(const Animated& animated) {
  std::optional<Performance> performance = performanceOf(animated);
  if (!performance) return std::nullopt;
  Exported made{
      animated, std::move(performance->file), std::move(performance->character), std::move(performance->motion), {}, {},
      {}};
  Result<ClosedBody> body = makeBody(made.character);
  EXPECT_TRUE(body.ok());
  if (!body.ok()) return std::nullopt;
  made.character = body->character;
  made.poses = coverPoses(made.character, std::span(&made.motion, 1)).value();
  made.colliders =
      makeRigidColliders(made.character, undivided(made.character), made.poses.sampledView(), {kVertices, true, 0})
          .value();
  made.model = rigidModelOf(made.character, made.colliders);
  return made;
}

CharacterDocument documentOf(const Exported& made) {
  if (!made.file) return characterDocument(made.character);
  return characterDocument({dataset(made.animated.character), &*made.file}).value();
}

std::vector<std::string> namesOf(const Exported& made) {
  std::vector<std::string> names;
  for (const RigidCollider& each : made.colliders) {
    names.push_back(made.character.skeleton.joint(each.joint).name + "_hull");
  }
  return plainNames(names);
}

}  // namespace lorica::test
