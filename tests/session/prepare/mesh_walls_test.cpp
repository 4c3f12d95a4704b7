#include "collision/hulls/mesh_walls.h"

#include "collision/hulls/character_walls.h"
#include "collision/hulls/mesh_subject.h"
#include "collision/world/world.h"
#include "geometry/convex_hull.h"
#include "geometry/counts.h"
#include "geometry/mass_properties.h"
#include "geometry/random_numbers.h"
#include "geometry/sheets.h"
#include "session/recording/session_file.h"
#include "tests/session/prepare/vessels.h"
#include "tests/skinning/body/hard_characters.h"
#include "tests/support/allocations.h"
#include "tests/support/has.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lorica::test {
namespace {

constexpr double kPi = std::numbers::pi;

TriMesh bothSides(const TriMesh& mesh) {
  TriMesh back = insideOut(mesh);
  return joined(mesh, back);
}

struct Vessel {
  std::string name;
  TriMesh mesh;                               ///< without thickness
  double area = 0.0;                          ///< of the sheet
  std::function<bool(const Vec3& p)> cavity;  ///< of the sheet, less 2.5 % of the longest side
  double filled = 0.0;                        ///< expected at most, share of the cavity at 32 parts
};

std::vector<Vessel> vessels() {
  std::vector<std::pair<double, double>> arc;
  for (int i = 0; i <= 15; ++i) arc.emplace_back(std::sin(kPi * i / 18), -std::cos(kPi * i / 18));  // up to 150 degrees
  std::vector<Vessel> all;
  // A bowl of 24 flat sides: frustum.
  all.push_back({"bowl", makeBowl(), 0.0,
                 [](const Vec3& p) {
                   return p.y() > 0.05 && p.y() < 0.7 && std::hypot(p.x(), p.z()) < 0.6 + 0.4 * p.y() / 0.7 - 0.07;
                 },
                 0.02});
  all.push_back({"tube", revolved({{0.5, -1}, {0.5, 1}}, 24), 0.0,
                 [](const Vec3& p) { return std::abs(p.y()) < 1.0 && std::hypot(p.x(), p.z()) < 0.44; }, 0.02});
  // Round patches of a sphere are never flat: 7 to 8 %.
  all.push_back({"sphere with a hole", revolved(arc, 24), 0.0,
                 [](const Vec3& p) { return p.norm() < 0.94 && p.y() < 0.8; }, 0.09});
  all.push_back({"open box", openBox(1.0), 20.0, [](const Vec3& p) { return p.cwiseAbs().maxCoeff() < 0.95; }, 1e-9});
  for (Vessel& vessel : all) vessel.area = surfaceArea(vessel.mesh.vertices, vessel.mesh.triangles);
  return all;
}

Mat3 turn(int i) {
  if (i == 0) return Mat3::Identity();
  Eigen::Vector4d q;
  for (int k = 0; k < 4; ++k) q[k] = randomUnit(7, 4 * i + k) - 0.5;
  return Quat(q.normalized()).toRotationMatrix();
}

bool inside(const ConvexHull& hull, const Vec3& p) {
  const std::array<Vec3, 1> points{p};
  return largestViolation(hull, points) <= 0.0;
}

/// The share of a cavity that hulls fill.
double filledShare(const Vessel& vessel, const Mat3& rotation, const std::vector<ConvexHull>& hulls) {
  int in = 0, filled = 0;
  for (int i = 0; in < 3000; ++i) {
    const Vec3 p(2.0 * randomUnit(3, 3 * i) - 1.0, 2.0 * randomUnit(3, 3 * i + 1) - 1.0,
                 2.0 * randomUnit(3, 3 * i + 2) - 1.0);
    if (!vessel.cavity(p)) continue;
    ++in;
    const Vec3 at = rotation * p;
    filled += std::ranges::any_of(hulls, [&](const ConvexHull& hull) { return inside(hull, at); }) ? 1 : 0;
  }
  return static_cast<double>(filled) / in;
}

TEST(MeshWalls, KeepThicknessAndHoldTheFilesVertices) {
  for (const Vessel& vessel : vessels()) {
    for (const bool doubled : {false, true}) {
      SCOPED_TRACE(vessel.name);
      CharacterOptions options;
      options.thickness = 0.02;
      const TriMesh mesh = doubled ? bothSides(vessel.mesh) : vessel.mesh;
      const WallBody body = wallsOf(mesh, options);
      EXPECT_TRUE(checkClosedTwoManifold(body.mesh));
      EXPECT_EQ(body.figures.shells, 1u);
      EXPECT_EQ(body.figures.solids, 0u);
      EXPECT_DOUBLE_EQ(body.figures.shellShare, 1.0);
      const double volume = signedVolume(body.mesh.vertices, body.mesh.triangles);
      EXPECT_NEAR(volume, 0.02 * vessel.area, 0.02 * 0.02 * vessel.area);
    }
  }
}

TEST(MeshWalls, OfTheDefaultThicknessAreAHundredthOfTheSize) {
  EXPECT_NEAR(wallsOf(openBox(1.0)).figures.thickness, 0.02, 1e-9);
  EXPECT_NEAR(wallsOf(openBox(50.0)).figures.thickness, 1.0, 1e-9);
}

TEST(MeshWalls, AreAtMostHalfOfTheNarrowestGap) {
  const TriMesh nested = joined(openBox(1.0), openBox(0.99));
  const WallBody body = wallsOf(nested);
  EXPECT_EQ(body.figures.shells, 2u);
  EXPECT_NEAR(body.figures.thickness, 0.005, 1e-4);
}

/// Long triangles have hundreds of samples each: of very many only some are taken.
TEST(MeshWalls, TheGapOfManyLongTrianglesTakesLittleMemory) {
  constexpr int kStrips = 2'000;
  TriMesh sheets;
  for (const double height : {0.0, 0.01}) {
    const VertexIndex first = countOf(sheets.vertices);
    for (int i = 0; i <= kStrips; ++i) {
      for (const double x : {0.0, 1.0}) sheets.vertices.emplace_back(x, height, static_cast<double>(i) / kStrips);
    }
    for (VertexIndex v = first; v < first + 2 * kStrips; v += 2) {
      sheets.triangles.push_back({v, v + 2, v + 1});
      sheets.triangles.push_back({v + 1, v + 2, v + 3});
    }
  }
  const AllocationWatch watch;
  EXPECT_NEAR(narrowestGap(sheets, std::vector<bool>(sheets.triangles.size(), true), 0.02), 0.01, 1e-4);
  EXPECT_LT(watch.largest(), std::size_t{20'000'000});
}

TEST(MeshWalls, LeaveVesselsEmpty) {
  for (const Vessel& vessel : vessels()) {
    for (int i = 0; i < 8; ++i) {
      const Mat3 rotation = turn(i);
      const TriMesh mesh = moved(vessel.mesh, [&](const Vec3& p) { return Vec3(rotation * p); });
      CharacterOptions options;
      options.thickness = 0.02;
      const std::vector<ConvexHull> hulls = hullsOf(wallsOf(mesh, options).mesh, 32);
      EXPECT_LE(filledShare(vessel, rotation, hulls), vessel.filled) << vessel.name << ", rotation " << i;
      // No vertex of the file is outside all hulls.
      for (const Vec3& p : mesh.vertices) {
        double out = kInfinity;
        for (const ConvexHull& hull : hulls) out = std::min(out, largestViolation(hull, std::array{p}));
        EXPECT_LT(out, 1e-6);
      }
    }
  }
}

/// Where a ball comes to rest that is dropped onto a vessel of these hulls.
Vec3 restOfABall(std::vector<ConvexHull> hulls, const TriMesh& shown) {
  auto shape = std::make_shared<PropMeshShape>();
  shape->solid = massProperties(shown.vertices, shown.triangles);
  Aabb box;
  for (const ConvexHull& hull : hulls) {
    for (const Vec3& p : hull.vertices) box.extend(p);
  }
  for (ConvexHull& hull : hulls) {
    for (Vec3& p : hull.vertices) p -= box.center();
  }
  shape->hulls = std::move(hulls);
  shape->shown = moved(shown, [&](const Vec3& p) { return Vec3(p - box.center()); });
  Prop vessel = meshProp(shape);
  vessel.mass = 0.0;
  vessel.worldFromProp = Isometry3(Eigen::Translation3d(box.center()));
  Prop ball;
  ball.shape = PropShape::kSphere;
  ball.halfExtents = Vec3::Constant(0.15);
  ball.worldFromProp = Isometry3(Eigen::Translation3d(0.2, 1.5, 0.1));
  World world;
  world.addProp(vessel);
  world.addProp(ball);
  for (int frame = 0; frame < 300; ++frame) world.step({}, 1.0 / 60.0);
  return world.props()[1].worldFromProp.translation();
}

TEST(MeshWalls, HoldABallThatIsDroppedIntoABowl) {
  const TriMesh bowl = makeBowl();
  const TriMesh walls = wallsOf(bowl).mesh;
  const Vec3 held = restOfABall(hullsOf(walls, 32), walls);
  EXPECT_LT(std::hypot(held.x(), held.z()), 0.6);
  EXPECT_GT(held.y(), 0.14);
  EXPECT_LT(held.y(), 0.3);
  // On the hull of all, it is not in the bowl.
  const Vec3 outside = restOfABall(hullsOf(walls, 1), walls);
  EXPECT_TRUE(outside.y() > 0.7 || std::hypot(outside.x(), outside.z()) > 1.0) << outside.transpose();
}

TEST(MeshWalls, LeaveClosedThingsSolid) {
  // A cup with a handle that is closed by itself, and touches it.
  const TriMesh cup = revolved({{0, 0}, {0.5, 0}, {0.5, 1}}, 24);
  const TriMesh handle = makeBox({0.49, 0.4, -0.1}, {0.9, 0.6, 0.1});
  const WallBody body = wallsOf(joined(cup, handle));
  EXPECT_EQ(body.figures.shells, 1u);
  EXPECT_EQ(body.figures.solids, 1u);
  EXPECT_LT(body.figures.shellShare, 0.95);
  // A mug of solid walls, and a box with a cavity: nothing is a sheet.
  const TriMesh mug = revolved({{0, 0}, {0.5, 0}, {0.5, 1}, {0.45, 1}, {0.45, 0.05}, {0, 0.05}}, 24);
  EXPECT_FALSE(valueOf(makeWalls(mug, {}, {})));
  EXPECT_FALSE(valueOf(makeWalls(makeHollowBox(), {}, {})));
}

TEST(MeshWalls, AreNotMadeAroundSpaceThatNothingReaches) {
  // Six squares whose edges do not meet: cracks of 0.2 % of the size.
  TriMesh squares;
  for (int side = 0; side < 6; ++side) {
    const int axis = side / 2;
    const double at = side % 2 == 0 ? -1.0 : 1.0;
    const VertexIndex first = countOf(squares.vertices);
    for (const auto& [u, v] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      Vec3 p;
      p[axis] = at;
      p[(axis + 1) % 3] = 0.998 * u * at;
      p[(axis + 2) % 3] = 0.998 * v;
      squares.vertices.push_back(p);
    }
    squares.triangles.push_back({first, first + 1, first + 2});
    squares.triangles.push_back({first, first + 2, first + 3});
  }
  EXPECT_FALSE(valueOf(makeWalls(squares, {}, {})));
  squares.triangles.resize(10);  // and without one of them, it is a vessel
  EXPECT_EQ(wallsOf(squares).figures.shells, 5u);
  CharacterOptions shell;
  shell.walls = WallChoice::kShell;
  EXPECT_EQ(wallsOf(makeBox({0, 0, 0}, {1, 1, 1}), shell).figures.shells, 1u);
}

TEST(MeshWalls, MakeFlatThingsSolid) {
  const TriMesh disc = revolved({{0, 0}, {1, 0}}, 32);
  for (const TriMesh& mesh : {disc, bothSides(disc)}) {
    const WallBody body = wallsOf(mesh);
    EXPECT_EQ(body.figures.shells, 1u);
    const double area = surfaceArea(disc.vertices, disc.triangles);
    EXPECT_NEAR(signedVolume(body.mesh.vertices, body.mesh.triangles), 0.02 * area, 1e-9);
    EXPECT_EQ(hullsOf(body.mesh, 8).size(), 1u);
  }
  // A sheet folded by 120 degrees: two parts.
  const TriMesh folded{{{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}, {-0.5, 0.9, 0}, {-0.5, 0.9, 1}},
                       {{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {0, 5, 4}}};
  const WallBody body = wallsOf(folded);
  EXPECT_EQ(body.figures.shells, 1u);
  EXPECT_EQ(hullsOf(body.mesh, 8).size(), 2u);
}

/// Two balls that overlap, and a sheet: the space that both fill counts once.
TEST(MeshWalls, BesideSolidsThatOverlap) {
  const double distance = 0.8;
  const TriMesh balls = joined(makeSphere(1.0, 24, 32), shifted(makeSphere(1.0, 23, 31), {distance, 0.01, 0.02}));
  const WallBody body = wallsOf(joined(balls, shifted(openBox(0.5), {0, 5, 0})));
  EXPECT_EQ(body.figures.solids, 2u);
  const double apart = Vec3(distance, 0.01, 0.02).norm();
  const double lens = kPi / 12.0 * (4.0 + apart) * (2.0 - apart) * (2.0 - apart);
  const double walls = 5.0 * body.figures.thickness;  // of a unit square each
  EXPECT_NEAR(signedVolume(body.mesh.vertices, body.mesh.triangles), 8.0 / 3.0 * kPi - lens + walls, 0.15);
}

TEST(MeshWalls, CanBeOneSided) {
  TriMesh strip;  // Moebius
  constexpr int kCount = 40;
  for (int i = 0; i < kCount; ++i) {
    const double angle = 2.0 * kPi * i / kCount;
    for (const double side : {-0.2, 0.2}) {
      const double r = 1.0 + side * std::cos(0.5 * angle);
      strip.vertices.emplace_back(r * std::cos(angle), side * std::sin(0.5 * angle), r * std::sin(angle));
    }
  }
  for (int i = 0; i < kCount; ++i) {
    const bool last = i + 1 == kCount;
    const VertexIndex a = 2 * i, b = 2 * i + 1, c = last ? 1 : 2 * i + 2, d = last ? 0 : 2 * i + 3;
    strip.triangles.push_back({a, b, c});
    strip.triangles.push_back({b, d, c});
  }
  const WallBody body = wallsOf(strip);
  EXPECT_TRUE(checkClosedTwoManifold(body.mesh));
  EXPECT_EQ(body.figures.shells, 1u);
}

TEST(MeshSubject, OfAnOpenBoxIsAVesselUnlessItIsCalledSolid) {
  Host host;
  CharacterOptions options;
  const Subject vessel = valueOf(meshSubject("box", openBox(1.0), options, host));
  EXPECT_LT(signedVolume(vessel.mesh.vertices, vessel.mesh.triangles), 0.5);
  EXPECT_NEAR(concavityUnitOf(vessel), 1.0, 1e-12);
  options.walls = WallChoice::kSolid;
  const Subject solid = valueOf(meshSubject("box", openBox(1.0), options, host));
  EXPECT_GT(signedVolume(solid.mesh.vertices, solid.mesh.triangles), 6.0);
}

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
  expectAll(body.walls, {"1 thin wall of 20.00 mm", "the rest is solid"});
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

/// A sheet of 1 x 2 m over a grid, at z = depth(x, y), half of it on each of two bones.
CharacterFile makeFlag(int columns, const std::function<double(double, double)>& depth) {
  Character flag = bonesAt({{"pole", kNoJoint, Vec3::Zero()}, {"end", 0, Vec3(0.0, 1.0, 0.0)}});
  const int rows = 2 * columns;
  for (const int half : {0, 1}) {
    TriMesh grid;
    for (int row = half * rows / 2; row <= (half + 1) * rows / 2; ++row) {
      for (int column = 0; column <= columns; ++column) {
        const double x = static_cast<double>(column) / columns - 0.5, y = 2.0 * row / rows;
        grid.vertices.emplace_back(x, y, depth(x, y));
        if (column == columns || row == (half + 1) * rows / 2) continue;
        const VertexIndex a = countOf(grid.vertices) - 1, above = a + columns + 1;
        grid.triangles.push_back({a, a + 1, above + 1});
        grid.triangles.push_back({a, above + 1, above});
      }
    }
    add(flag, grid, half);
  }
  CharacterFile file;
  file.character = finished(std::move(flag));
  file.character.name = "flag";
  return file;
}

/// Flags, paper figures: nothing of them encloses anything, so nobody has to ask for walls.
TEST(CharacterWalls, AreMadeOfWhatIsSheetsOnly) {
  const auto flat = [](double, double) { return 0.0; };
  const auto waves = [](double x, double y) { return 0.1 * std::sin(6.0 * x + 3.0 * y); };
  std::vector<std::pair<const char*, CharacterFile>> flags = {
      {"flat", makeFlag(1, flat)}, {"fine", makeFlag(6, flat)}, {"wavy", makeFlag(8, waves)}};
  flags.emplace_back("from both sides", makeFlag(3, flat));
  {
    TriMesh& mesh = flags.back().second.character.mesh;
    const std::vector<Triangle> front = mesh.triangles;
    for (const auto& [a, b, c] : front) mesh.triangles.push_back({a, c, b});
  }
  Character paper = bonesAt({{"body", kNoJoint, Vec3::Zero()}, {"arm", 0, Vec3(0.3, 1.4, 0.0)}});
  for (int piece = 0; piece < 6; ++piece) {
    TriMesh card{{{0, 0, 0}, {0.3, 0, 0}, {0.3, 0.2, 0}, {0, 0.2, 0}}, {{0, 1, 2}, {0, 2, 3}}};
    add(paper, moved(card, [&](const Vec3& p) { return Vec3(p + Vec3(0.05, 0.3 * piece, 0.02 * piece)); }), piece / 5);
  }
  CharacterFile figure;
  figure.character = finished(std::move(paper));
  figure.character.name = "figure";
  flags.emplace_back("paper figure", figure);

  for (const auto& [name, file] : flags) {
    SCOPED_TRACE(name);
    const Character& flag = file.character;
    const ClosedBody body = valueOf(bodyOf(file, std::nullopt, 0.0));
    EXPECT_TRUE(has(body.walls, "100 % of the surface"));
    EXPECT_TRUE(has(body.walls, "nothing is solid"));
    EXPECT_TRUE(checkClosedTwoManifold(body.character.mesh));
    EXPECT_TRUE(checkCharacter(body.character));
    EXPECT_EQ(body.character.height, flag.height);
    EXPECT_EQ(body.character.shown.size(), flag.mesh.triangles.size());
    const double volume = volumeOf(body.character, body.character.mesh.vertices);
    EXPECT_GT(volume, 0.0);
    EXPECT_LT(volume, 0.06);
    // A bone that moves takes its sheets along: every visible vertex is where its own bone puts it.
    const Affine3 moving = Eigen::Translation3d(0.2, 0.3, -0.4) * Eigen::AngleAxisd(0.7, Vec3(3, 1, 2).normalized());
    const std::vector<Vec3> points = posed(body.character, moving), truth = posed(flag, moving);
    ASSERT_EQ(points.size(), body.bodyVertices + truth.size());
    for (std::size_t v = 0; v < truth.size(); ++v) EXPECT_EQ(points[body.bodyVertices + v], truth[v]);
    EXPECT_TRUE(bodyOf(file, WallChoice::kSolid, 0.0).ok() == (std::string_view(name) == "wavy"));
  }
}

TEST(CharacterWalls, OfEverythingLeaveNothingSolid) {
  const ClosedBody body = valueOf(bodyOf(makeLamp(), WallChoice::kShell));
  expectAll(body.walls, {"2 thin walls of 20.00 mm, 100 % of the surface", "nothing is solid"});
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
