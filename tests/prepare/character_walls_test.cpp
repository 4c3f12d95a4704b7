#include "prepare/character_walls.h"

#include "session/recording/session_file.h"
#include "tests/prepare/vessels.h"
#include "tests/skinning/body/hard_characters.h"
#include "tests/support/has.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace lorica::test {
namespace {

constexpr double kThickness = 0.02;

/// Where the axis of the lamp's shade is: joint 1 moves it, joint 0 the foot.
const Vec3 kShade(0.0, 1.0, 0.0);

/// A closed foot and a shade, a tube of 24 flat sides without a thickness, whose triangles are there from both sides.
CharacterFile makeLamp() {
  Character lamp = bonesAt({{"foot", kNoJoint, Vec3::Zero()}, {"shade", 0, kShade}});
  add(lamp, makeBox({-0.2, 0.0, -0.2}, {0.2, 0.4, 0.2}), 0);
  const TriMesh tube = moved(revolved({{0.3, -0.3}, {0.3, 0.3}}, 24), [](const Vec3& p) { return Vec3(p + kShade); });
  add(lamp, joined(tube, insideOut(tube)), 1);
  CharacterFile file;
  file.character = finished(std::move(lamp));
  file.character.name = "lamp";
  return file;
}

Result<ClosedBody> bodyOf(const CharacterFile& file, std::optional<WallChoice> walls, double thickness = kThickness) {
  CharacterOptions options;
  options.walls = walls;
  options.thickness = thickness;
  return bodyWithWalls(file, options, [](const Character& rest) { return makeBody(rest); });
}

double volumeOf(const Character& body, std::span<const Vec3> at) {
  return signedVolume(at, body.mesh.triangles);
}

/// The body's points with the shade moved.
std::vector<Vec3> posed(const Character& body, const Affine3& moving) {
  std::vector<Vec3> points;
  points.reserve(body.mesh.vertices.size());
  for (std::size_t v = 0; v < body.mesh.vertices.size(); ++v) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = body.influenceBegin[v]; i < body.influenceBegin[v + 1]; ++i) {
      const auto& [joint, weight] = body.influences[i];
      sum += weight * (joint == 1 ? Vec3(moving * body.mesh.vertices[v]) : body.mesh.vertices[v]);
    }
    points.push_back(sum);
  }
  return points;
}

TEST(CharacterWalls, AreMadeOfASheetAndFollowItsBone) {
  const CharacterFile lamp = makeLamp();
  const ClosedBody body = valueOf(bodyOf(lamp, WallChoice::kByReach));
  EXPECT_TRUE(checkClosedTwoManifold(body.character.mesh));
  EXPECT_TRUE(checkCharacter(body.character));
  EXPECT_TRUE(has(body.walls, "1 thin wall of 20.00 mm"));
  EXPECT_TRUE(has(body.walls, "the rest is solid"));
  // A foot of 0.4 x 0.4 x 0.4, and walls as large as the tube.
  const double side = 2.0 * 0.3 * std::sin(std::numbers::pi / 24);
  const double expected = 0.064 + kThickness * 24 * side * 0.6;
  EXPECT_NEAR(volumeOf(body.character, body.character.mesh.vertices), expected, 0.01 * expected);

  // The bone turns and moves the walls as one piece, so the thickness stays; the foot does not move.
  const Affine3 moving = Eigen::Translation3d(0.5, 0.7, -0.2) * Eigen::AngleAxisd(1.0, Vec3(1, 2, 3).normalized());
  const std::vector<Vec3> points = posed(body.character, moving);
  EXPECT_NEAR(volumeOf(body.character, points), expected, 0.01 * expected);
  for (VertexIndex v = 0; v < body.bodyVertices; ++v) {
    const Vec3& was = body.character.mesh.vertices[v];
    const Vec3 expectedAt = was.y() > 0.5 ? Vec3(moving * was) : was;
    EXPECT_LT((points[v] - expectedAt).norm(), 1e-12);
  }
  // All visible vertices are still there, and no triangle of the body uses them.
  EXPECT_EQ(body.character.mesh.vertices.size() - body.bodyVertices, lamp.character.mesh.vertices.size());
  EXPECT_EQ(body.character.shown.size(), lamp.character.mesh.triangles.size());
}

TEST(CharacterWalls, AreNotMadeUnlessAskedFor) {
  const CharacterFile lamp = makeLamp();
  const ClosedBody whole = valueOf(makeBody(lamp.character));
  for (const std::optional<WallChoice> walls : {std::optional<WallChoice>(), std::optional(WallChoice::kSolid)}) {
    const ClosedBody body = valueOf(bodyOf(lamp, walls, 0.0));
    EXPECT_EQ(hashOf(body.character), hashOf(whole.character));
    EXPECT_EQ(body.walls, "");
  }
  EXPECT_TRUE(has(bodyOf(lamp, std::nullopt).error().message, "expected --walls auto or shell"));
  EXPECT_TRUE(has(bodyOf(lamp, WallChoice::kByReach, 0.3).error().message, "an eighth of the longest side"));
}

TEST(CharacterWalls, OfEverythingLeaveNothingSolid) {
  const ClosedBody body = valueOf(bodyOf(makeLamp(), WallChoice::kShell));
  EXPECT_TRUE(has(body.walls, "2 thin walls of 20.00 mm, 100 % of the surface"));
  EXPECT_TRUE(has(body.walls, "nothing is solid"));
  EXPECT_TRUE(checkClosedTwoManifold(body.character.mesh));
  EXPECT_LT(volumeOf(body.character, body.character.mesh.vertices), 0.045);
}

TEST(CharacterWalls, AreNotMadeAroundWhatIsClosedOff) {
  // Without a lid the foot is a sheet that the shade's plate, a closed box, closes off.
  CharacterFile lamp = makeLamp();
  Character closed = bonesAt({{"foot", kNoJoint, Vec3::Zero()}, {"plate", 0, kShade}});
  TriMesh foot = moved(openBox(0.2), [](const Vec3& p) { return Vec3(p + Vec3(0.0, 0.2, 0.0)); });
  add(closed, foot, 0);
  add(closed, makeBox({-0.25, 0.35, -0.25}, {0.25, 0.5, 0.25}), 1);
  lamp.character = finished(std::move(closed));
  EXPECT_EQ(valueOf(bodyOf(lamp, WallChoice::kByReach)).walls, "");
}

TEST(CharacterWalls, AreNotMadeOfSmallSheets) {
  CharacterFile lamp = makeLamp();
  Character tagged = lamp.character;
  TriMesh tag;
  tag.vertices = {{0.0, 2.0, 0.0}, {0.1, 2.0, 0.0}, {0.0, 2.1, 0.0}};
  tag.triangles = {{0, 1, 2}};
  add(tagged, tag, 1);
  lamp.character = finished(std::move(tagged));
  EXPECT_TRUE(has(valueOf(bodyOf(lamp, WallChoice::kByReach)).walls, "1 thin wall of "));
  EXPECT_TRUE(has(valueOf(bodyOf(lamp, WallChoice::kShell)).walls, "3 thin walls of "));
}

}  // namespace
}  // namespace lorica::test
