#include "acd/piece.h"

#include "acd/cap.h"
#include "geometry/counts.h"
#include "tests/acd/hard_meshes.h"
#include "tests/acd/parts.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

namespace lorica {
namespace {

/// All positions of a mesh in several keyframes, each the mesh's own pose after a map.
template <class... Maps>
std::vector<Vec3> keyframesOf(const TriMesh& mesh, Maps... maps) {
  std::vector<Vec3> positions;
  const auto add = [&](auto map) { positions.insert(positions.end(), map.begin(), map.end()); };
  (add(test::moved(mesh, maps).vertices), ...);
  return positions;
}

CutContext contextOf(const TriMesh& mesh, const std::vector<Vec3>& positions) {
  return {mesh, {positions, countOf(mesh.vertices)}};
}

/// Cuts a part, and adds the new points to the context.
std::array<Part, 2> cut(const Part& part, CutContext& context, const Plane& plane) {
  CutResult halves = cutPart(part, context.points[0], plane, context.onPlane[0], context.pointCount());
  context.addCutPoints(halves.newPoints);
  return {std::move(halves.below), std::move(halves.above)};
}

/// As unite(), which takes a span: for lists of parts written out.
Part united(const std::vector<const Part*>& parts) {
  return unite(parts);
}

double areaOfCaps(const Part& part, const CutContext& context) {
  return surfaceArea(context.points[0], test::capsOf(part));
}

TEST(CutContext, FlatTrianglesHaveNoNormalAndNoVolume) {
  const TriMesh box = test::makeBox({0, 0, 0}, {1, 2, 3});
  const auto same = [](const Vec3& v) { return v; };
  const auto doubled = [](const Vec3& v) -> Vec3 { return 2.0 * v; };
  const auto flat = [](const Vec3& v) { return Vec3(v.x(), 0, v.z()); };
  const std::vector<Vec3> positions = keyframesOf(box, same, doubled, flat);
  const CutContext context = contextOf(box, positions);
  ASSERT_EQ(context.keyframeCount(), 3u);
  EXPECT_EQ(context.pointCount(), 8);
  EXPECT_TRUE(context.cutPoints.empty());
  EXPECT_DOUBLE_EQ(context.meshVolume[0], 6.0);
  EXPECT_DOUBLE_EQ(context.meshVolume[1], 48.0);
  EXPECT_EQ(context.meshVolume[2], 0.0);
  for (std::size_t i = 0; i < box.triangles.size(); ++i) {
    const Triangle& t = box.triangles[i];
    // An outward normal leads away from the centre, along one axis.
    const Vec3 normal = context.normals[0][i];
    EXPECT_EQ(normal.cwiseAbs().sum(), 1.0);
    EXPECT_GT(normal.dot(box.vertices[t[0]] - Vec3(0.5, 1, 1.5)), 0.0);
    EXPECT_EQ(context.normals[1][i], normal);
    // Without its height the box has only its bottom and top.
    EXPECT_EQ(context.normals[2][i], normal.y() == 0.0 ? Vec3(0, 0, 0) : normal);
  }
}

TEST(CutContext, CoplanarVerticesStayOnTheirPlaneFarFromTheOrigin) {
  test::Dice dice(31);
  const TriMesh shape = test::makeLShape();
  for (const double distance : {0.0, 10.0, 1e5, 1e9}) {
    for (int trial = 0; trial < 20; ++trial) {
      const Quat rotation = dice.rotation();
      const Vec3 shift = distance * (rotation * Vec3::UnitX()) + dice.inBox(1.0);
      const std::vector<Vec3> positions =
          keyframesOf(shape, [&](const Vec3& v) -> Vec3 { return rotation * v + shift; });
      const CutContext context = contextOf(shape, positions);
      EXPECT_LT(context.onPlane[0], 1e-8 + 1e-14 * distance);
      // The planes of the inner faces, x = 1 and y = 1, contain four vertices each, and the bottom, z = 0, six.
      for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
        const double level = axis.z() == 0.0 ? 1.0 : 0.0;
        const Vec3 normal = rotation * axis;
        const double offset = normal.dot(rotation * (level * axis) + shift);
        for (std::size_t i = 0; i < positions.size(); ++i) {
          const bool onPlane = std::abs(normal.dot(positions[i]) - offset) <= context.onPlane[0];
          EXPECT_EQ(onPlane, axis.dot(shape.vertices[i]) == level) << "vertex " << i << " at " << distance;
        }
      }
    }
  }
}

TEST(CutContext, CutPointsFollowTheirEndsInEveryKeyframe) {
  const TriMesh mesh = test::makeTetrahedron();
  const auto same = [](const Vec3& v) { return v; };
  const auto moved = [](const Vec3& v) { return Vec3(4.0 * v.y() + 1.0, 8.0 * v.x(), -2.0 * v.z()); };
  const std::vector<Vec3> positions = keyframesOf(mesh, same, moved);
  CutContext context = contextOf(mesh, positions);
  context.addCutPoints(std::vector<CutPoint>{{0, 1, 0.25}, {2, 4, 0.5}});  // the second needs the first
  context.addCutPoints(std::vector<CutPoint>{{3, 5, 0.75}});
  EXPECT_EQ(context.pointCount(), 7);
  ASSERT_EQ(context.cutPoints.size(), 3u);
  EXPECT_EQ(context.cutPoints[2].second, 5);
  const std::vector<Vec3> expected = {{0.75, 0, 0}, {0.375, 0.5, 0}, {0.09375, 0.125, 0.75}};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(context.points[0][4 + i], expected[i]);
    EXPECT_EQ(context.points[1][4 + i], moved(expected[i])) << "an affine map keeps ratios";
  }
}

TEST(Piece, IsMeasuredInEveryKeyframe) {
  const TriMesh mesh = test::makeLShape();
  const auto same = [](const Vec3& v) { return v; };
  const auto doubled = [](const Vec3& v) -> Vec3 { return 2.0 * v; };
  const auto flat = [](const Vec3& v) { return Vec3(v.x(), v.y(), 0); };
  // The outer corner pulled in to the inner one: a box of 1 x 2 x 1 is left.
  const auto folded = [](const Vec3& v) { return Vec3(std::min(v.x(), 1.0), v.y(), v.z()); };
  const std::vector<Vec3> positions = keyframesOf(mesh, same, doubled, flat, folded);
  const CutContext context = contextOf(mesh, positions);
  const Piece piece = measure(test::wholeOf(mesh), context);
  // The hull adds a prism over the triangle between the arms, of area 1/2.
  const std::vector<double> volumes = {3.0, 24.0, 0.0, 2.0}, hullVolumes = {3.5, 28.0, 0.0, 2.0};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(piece.volume[k], volumes[k], 1e-12) << k;
    EXPECT_NEAR(piece.hullVolume[k], hullVolumes[k], 1e-12) << k;
    EXPECT_NEAR(piece.error(k), hullVolumes[k] - volumes[k], 1e-12) << k;
  }
  EXPECT_NEAR(piece.totalError(), 4.5, 1e-12);
  EXPECT_NEAR(piece.totalHullVolume(), 33.5, 1e-12);
  // All but the inner corners, 3 and 9.
  const std::vector<PointIndex> outer = {0, 1, 2, 4, 5, 6, 7, 8, 10, 11};
  EXPECT_EQ(piece.hullPoints[0], outer);
  EXPECT_EQ(piece.hullPoints[1], outer);
  EXPECT_EQ(piece.part.points.size(), 12u);
}

TEST(Unite, RestoresWhatWasCut) {
  // A bar cut at x = 1 and x = 2: slabs 0 and 1 share a cap, and so do 1 and 2, but not 0 and 2.
  const TriMesh bar = test::makeBox({0, 0, 0}, {3, 2, 1});
  const std::vector<Vec3> positions = bar.vertices;
  CutContext context = contextOf(bar, positions);
  EXPECT_TRUE(united({}).triangles.empty());
  EXPECT_TRUE(united({}).points.empty());

  const auto [first, rest] = cut(test::wholeOf(bar), context, {Vec3::UnitX(), 1.0});
  const auto [second, third] = cut(rest, context, {Vec3::UnitX(), 2.0});
  struct Case {
    std::vector<const Part*> parts;
    double volume, capArea;
  };
  for (const Case& c : {Case{{&second}, 2.0, 4.0}, Case{{&first, &second}, 4.0, 2.0}, Case{{&third, &second}, 4.0, 2.0},
                        Case{{&first, &third}, 4.0, 4.0}, Case{{&third, &first, &second}, 6.0, 0.0}}) {
    SCOPED_TRACE(testing::Message() << c.parts.size() << " parts, volume " << c.volume << ", caps " << c.capArea);
    const Part whole = united(c.parts);
    EXPECT_NEAR(signedVolume(context.points[0], whole.triangles), c.volume, 1e-12);
    EXPECT_NEAR(areaOfCaps(whole, context), c.capArea, 1e-12);
    EXPECT_TRUE(test::isClosed(whole.triangles));
    EXPECT_EQ(whole.points, pointsUsedBy(whole.triangles));
    EXPECT_EQ(whole.sourceTriangle.size(), whole.triangles.size());
  }
  const Part alone = united({&second});
  EXPECT_EQ(alone.triangles, second.triangles);
  EXPECT_EQ(alone.sourceTriangle, second.sourceTriangle);
}

TEST(Unite, IsClosedAndKeepsTheSurfaceForAnyCuts) {
  test::Dice dice(32);
  const TriMesh torus = test::makeTorus(1.0, 0.4, 24, 10);
  for (int trial = 0; trial < 10; ++trial) {
    SCOPED_TRACE(testing::Message() << "trial " << trial);
    CutContext context = contextOf(torus, torus.vertices);
    std::vector<Part> parts = {test::wholeOf(torus)};
    for (int cuts = 0; cuts < 3; ++cuts) {
      const Plane plane{dice.inBox(1.0).normalized(), dice.between(-0.3, 0.3)};
      std::vector<Part> next;
      for (const Part& part : parts) {
        for (Part& half : cut(part, context, plane)) next.push_back(std::move(half));
      }
      parts = std::move(next);
    }
    // In random order, one part more each time. A cap that a later cut divided on one side only does not cancel.
    for (std::size_t i = parts.size(); i-- > 1;) {
      std::swap(parts[i], parts[static_cast<std::size_t>(dice.whole(0, static_cast<int>(i)))]);
    }
    std::vector<const Part*> some;
    double volume = 0.0, surface = 0.0, caps = 0.0;
    Part stepwise;
    for (const Part& part : parts) {
      some.push_back(&part);
      volume += signedVolume(context.points[0], part.triangles);
      caps += areaOfCaps(part, context);
      surface += surfaceArea(context.points[0], part.triangles) - areaOfCaps(part, context);
      stepwise = united({&stepwise, &part});
      for (const Part& whole : {unite(some), stepwise}) {
        const double capArea = areaOfCaps(whole, context);
        EXPECT_TRUE(test::isClosed(whole.triangles));
        EXPECT_EQ(whole.points, pointsUsedBy(whole.triangles));
        EXPECT_NEAR(signedVolume(context.points[0], whole.triangles), volume, 1e-12);
        EXPECT_NEAR(surfaceArea(context.points[0], whole.triangles) - capArea, surface, 1e-12);
        EXPECT_LE(capArea, caps + 1e-12);
      }
    }
    EXPECT_NEAR(volume, signedVolume(torus.vertices, torus.triangles), 1e-12);
    EXPECT_NEAR(surface, surfaceArea(torus.vertices, torus.triangles), 1e-11);
    EXPECT_LT(areaOfCaps(stepwise, context), 0.5 * caps) << "most caps are shared";
  }
}

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

double areaOf(std::span<const Vec2> v, std::span<const Triangle> triangles) {
  double sum = 0.0;
  for (const Triangle& t : triangles) sum += 0.5 * cross(v[t[1]] - v[t[0]], v[t[2]] - v[t[0]]);
  return sum;
}

double areaOf(std::span<const Vec2> v, std::span<const CapEdge> edges) {
  double sum = 0.0;
  for (const CapEdge& e : edges) sum += 0.5 * cross(v[e[0]], v[e[1]]);
  return sum;
}

double boundsArea(std::span<const Vec2> v) {
  Vec2 low = Vec2::Zero(), high = Vec2::Zero();
  for (const Vec2& p : v) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).prod();
}

/// Checks that the triangles' border consists of exactly the given edges, and that no triangle is flipped.
void expectFills(std::span<const Vec2> v, std::span<const CapEdge> edges, bool allPositive = true) {
  const std::vector<Triangle> triangles = triangulateCap(v, edges);
  std::map<std::pair<int, int>, int> border;
  for (const Triangle& t : triangles) {
    for (int e = 0; e < 3; ++e) {
      const int a = t[e], b = t[(e + 1) % 3];
      ++border[{a, b}];
      --border[{b, a}];
    }
    if (allPositive) {
      EXPECT_GE(areaOf(v, std::span(&t, 1)), 0.0);
    }
  }
  for (const CapEdge& e : edges) {
    --border[{e[0], e[1]}];
    ++border[{e[1], e[0]}];
  }
  for (const auto& [edge, count] : border) EXPECT_EQ(count, 0) << edge.first << "-" << edge.second;
  EXPECT_NEAR(areaOf(v, triangles), areaOf(v, edges), 1e-12 * std::max(1.0, boundsArea(v)));
}

std::vector<Vec2> circle(Vec2 center, double radius, int count, bool clockwise) {
  std::vector<Vec2> loop;
  for (int i = 0; i < count; ++i) {
    const double a = 2.0 * std::numbers::pi * i / count * (clockwise ? -1 : 1);
    loop.push_back(center + radius * Vec2(std::cos(a), std::sin(a)));
  }
  return loop;
}

/// Checks the cap of several loops.
void expectFills(const std::vector<std::vector<Vec2>>& loops, bool allPositive = true) {
  std::vector<Vec2> v;
  std::vector<CapEdge> edges;
  for (const std::vector<Vec2>& loop : loops) {
    const int first = countOf(v), count = countOf(loop);
    v.insert(v.end(), loop.begin(), loop.end());
    for (int i = 0; i < count; ++i) edges.push_back({first + i, first + (i + 1) % count});
  }
  expectFills(v, edges, allPositive);
}

TEST(Cap, LoopsThatTouchInAVertexComeApart) {
  //  two squares that share vertex 2
  const std::vector<Vec2> v = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 1}, {2, 2}, {1, 2}};
  const std::vector<CapEdge> edges = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {2, 4}, {4, 5}, {5, 6}, {6, 2}};
  expectFills(v, edges);
  EXPECT_EQ(triangulateCap(v, edges).size(), 4u);
}

TEST(Cap, RandomCellsOfAGrid) {
  // Unions of squares: collinear runs, holes, islands, corners where four edges meet.
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 200; ++trial) {
    SCOPED_TRACE(trial);
    const int n = 2 + static_cast<int>(random() % 9);
    std::vector<bool> filled(n * n);
    for (std::size_t i = 0; i < filled.size(); ++i) filled[i] = random() % 8 < 5;
    const auto at = [&](int x, int y) { return x >= 0 && y >= 0 && x < n && y < n && filled[y * n + x]; };
    std::vector<Vec2> v;
    for (int y = 0; y <= n; ++y) {
      for (int x = 0; x <= n; ++x) v.emplace_back(x, y);
    }
    const auto vertex = [&](int x, int y) { return y * (n + 1) + x; };
    std::vector<CapEdge> edges;
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        if (!at(x, y)) continue;
        if (!at(x, y - 1)) edges.push_back({vertex(x, y), vertex(x + 1, y)});
        if (!at(x + 1, y)) edges.push_back({vertex(x + 1, y), vertex(x + 1, y + 1)});
        if (!at(x, y + 1)) edges.push_back({vertex(x + 1, y + 1), vertex(x, y + 1)});
        if (!at(x - 1, y)) edges.push_back({vertex(x, y + 1), vertex(x, y)});
      }
    }
    expectFills(v, edges);
  }
}

TEST(Cap, LoopsWithHolesAndIslandsAreFilled) {
  EXPECT_TRUE(triangulateCap({}, {}).empty());
  const std::vector<Vec2> convex = circle({0, 0}, 1, 17, false);
  std::vector<Vec2> star = circle({0, 0}, 1, 24, false), straight;
  for (std::size_t i = 0; i < star.size(); ++i) star[i] = (i % 2 ? 1.0 : 0.3) * star[i] + Vec2(5, 0);
  for (int i = 0; i < 10; ++i) straight.emplace_back(i, 0);
  for (int i = 0; i < 10; ++i) straight.emplace_back(10, i);
  for (int i = 0; i < 10; ++i) straight.emplace_back(10 - i, 10);
  for (int i = 0; i < 10; ++i) straight.emplace_back(0, 10 - i);
  std::vector<std::vector<Vec2>> grid = {{{-1, -1}, {21, -1}, {21, 21}, {-1, 21}}};
  for (double x = 0; x < 20; x += 2) {
    for (double y = 0; y < 20; y += 2) grid.push_back({{x, y}, {x, y + 1}, {x + 1, y + 1}, {x + 1, y}});
  }
  // Would take minutes if each corner were tested against all others.
  std::vector<std::vector<Vec2>> large = {{}, {{999, -1}, {1051, -1}, {1051, 51}, {999, 51}}};
  constexpr int kSteps = 5000;
  for (int i = 0; i < 2 * kSteps; ++i) {
    const int step = i < kSteps ? i : 2 * kSteps - 1 - i;
    const double angle = 40.0 * std::numbers::pi * step / kSteps, r = (i < kSteps ? 5.0 : 3.0) + angle;
    large[0].emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  for (int x = 0; x < 50; ++x) {
    for (int y = 0; y < 50; ++y) large.push_back(circle({1000.5 + x, 0.5 + y}, 0.3, 6, true));
  }
  const std::vector<std::vector<Vec2>> island = {circle({0, 0}, 10, 40, false), circle({-4, 0}, 2, 12, true),
                                                 circle({4, 0}, 3, 9, true),    circle({4, 0}, 1, 8, false),
                                                 circle({0, 5}, 1, 6, true),    circle({0, -5}, 1, 6, true)};
  for (const auto& [what, loops] : std::initializer_list<std::pair<const char*, std::vector<std::vector<Vec2>>>>{
           {"convex", {convex}},
           {"convex and a star", {convex, star}},
           {"holes and an island in a hole", island},
           {"many holes in a grid", grid},
           {"collinear vertices", {straight}},
           {"a long spiral and thousands of holes", large}}) {
    SCOPED_TRACE(what);
    expectFills(loops);
  }
}

TEST(Cap, CrossingLoopsStillClose) {
  // Would take minutes: no corner of these teeth is an ear, and tens of thousands of loops meet in one corner.
  constexpr int kTeeth = 50'000;
  std::vector<Vec2> comb = {{-1, -2}, {1, -2}}, petals = {{0, 0}};
  std::vector<CapEdge> around;
  for (int i = 0; i < kTeeth; ++i) {
    comb.emplace_back(-1.0 + 2.0 * i / kTeeth, i % 2);
    const double angle = 2.0 * std::numbers::pi * i / kTeeth;
    for (const double side : {0.1, 0.7}) {
      const double at = angle + side * 2.0 * std::numbers::pi / kTeeth;
      petals.emplace_back(std::cos(at), std::sin(at));
    }
    const int first = countOf(petals) - 2;
    around.insert(around.end(), {{0, first}, {first, first + 1}, {first + 1, 0}});
  }
  expectFills({comb}, false);
  expectFills(petals, around, false);
  expectFills({circle({0, 0}, 2, 20, false),
               circle({1.5, 0}, 2, 20, false),
               {{0, 0}, {1, 1}, {1, 0}, {0, 1}},  // a bow-tie
               circle({9, 9}, 1, 5, true)},       // a hole in nothing
              false);
}

}  // namespace
}  // namespace lorica
