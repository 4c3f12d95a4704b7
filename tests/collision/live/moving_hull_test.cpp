#include "collision/live/moving_hull.h"

#include "tests/collision/live/moving_hull_truth.h"
#include "tests/collision/parts.h"
#include "tests/support/instruction_sets.h"

#include <gtest/gtest.h>

#include <functional>
#include <numbers>

namespace lorica::test {
namespace {

using Cloud = std::vector<Vec3>;
using Random = std::mt19937_64;

// Shapes of about unit size.

Cloud sphere(int count, Random& random) {
  Cloud points;
  points.reserve(count);
  for (int i = 0; i < count; ++i) points.push_back(uniformRotation(random) * Vec3::UnitX());
  return points;
}

Cloud ellipsoid(int count, Random& random) {
  Cloud points = sphere(count, random);
  for (Vec3& p : points) p = p.cwiseProduct(Vec3(1.0, 0.4, 0.1));
  return points;
}

Cloud ball(int count, Random& random) {
  Cloud points = sphere(count, random);
  for (Vec3& p : points) p *= std::cbrt(uniform(random, 0.0, 1.0));
  return points;
}

Cloud cube(int count, Random& random) {
  Cloud points;
  points.reserve(count);
  for (int i = 0; i < count; ++i) points.push_back(uniformVec3(random, -1.0, 1.0));
  return points;
}

// A grid on the faces of a box and through it: most points are coplanar or collinear with many others.
Cloud boxGrid(int cells) {
  Cloud points;
  points.reserve(static_cast<std::size_t>((cells + 1) * (cells + 1) * (cells + 1)));
  for (int x = 0; x <= cells; ++x) {
    for (int y = 0; y <= cells; ++y) {
      for (int z = 0; z <= cells; ++z) points.push_back(2.0 * Vec3(x, y, z) / cells - Vec3::Ones());
    }
  }
  return points;
}

Cloud cylinder(int around, int rings) {
  Cloud points = {Vec3(0, 0, -1), Vec3(0, 0, 1)};
  for (int r = 0; r < rings; ++r) {
    for (int i = 0; i < around; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / around;
      for (const double radius : {0.5, 0.25}) {
        points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 2.0 * r / (rings - 1) - 1.0);
      }
    }
  }
  return points;
}

Cloud twice(Cloud points) {
  const Cloud copy = points;
  points.insert(points.end(), copy.begin(), copy.end());
  return points;
}

Cloud scaled(Cloud points, const Vec3& by) {
  for (Vec3& p : points) p = p.cwiseProduct(by);
  return points;
}

struct Shape {
  const char* name;
  Cloud points;
};

std::vector<Shape> shapes() {
  Random random(5);
  return {{"sphere", sphere(160, random)},
          {"ellipsoid", ellipsoid(160, random)},
          {"ball", ball(200, random)},
          {"cube", cube(200, random)},
          {"box grid", boxGrid(4)},
          {"fine box grid", boxGrid(6)},
          {"cylinder", cylinder(16, 4)},
          {"doubled cylinder", twice(cylinder(9, 3))},
          {"doubled sphere", twice(sphere(70, random))},
          {"plate of a few ticks", scaled(cube(150, random), Vec3(1, 1, 3e-6))},
          {"plate grid of a few ticks", scaled(boxGrid(4), Vec3(1, 1, 3e-6))},
          {"needle", scaled(ball(150, random), Vec3(1, 2e-5, 2e-5))},
          {"tetrahedron", {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)}},
          {"octahedron", {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)}},
          {"nine points", ball(9, random)}};
}

constexpr double kTicks = 1 << 20;  // of one unit

// Runs a shape through poses, each a function of the frame and the rest position, and checks every frame.
using Motion = std::function<Vec3(int frame, const Vec3& rest)>;

MovingHull::Counts expectFollows(const Shape& shape, int frames, const Motion& motion) {
  MovingHull hull(static_cast<int>(shape.points.size()));
  MovingHull::Counts sum;
  for (int frame = 0; frame < frames; ++frame) {
    Cloud posed = shape.points;
    for (Vec3& p : posed) p = motion(frame, p);
    const std::vector<PointRow> rows = aboutTheirMean(posed, kTicks);
    const std::vector<Triangle> faces(hull.faces().begin(), hull.faces().end());
    const std::vector<VertexIndex> vertices(hull.vertices().begin(), hull.vertices().end());
    hull.update(rows);
    if (hull.keptFaces()) {
      EXPECT_TRUE(std::ranges::equal(hull.faces(), faces)) << shape.name << ", frame " << frame;
      EXPECT_TRUE(std::ranges::equal(hull.vertices(), vertices)) << shape.name << ", frame " << frame;
    }
    const std::string wrong = whatIsWrong(hull, rows);
    EXPECT_EQ(wrong, "") << shape.name << ", frame " << frame;
    if (!wrong.empty()) break;
    sum.turnedFaces += hull.counts().turnedFaces;
    sum.flips += hull.counts().flips;
    sum.deletions += hull.counts().deletions;
    sum.insertions += hull.counts().insertions;
    sum.failedCertificates += hull.counts().failedCertificates;
    sum.rebuilds += hull.counts().rebuilds;
  }
  return sum;
}

Vec3 twisted(const Vec3& p, double angle) {
  return Eigen::AngleAxisd(angle * p.x(), Vec3::UnitX()) * p;
}

Vec3 bent(const Vec3& p, double angle) {
  if (std::abs(angle) < 1e-9) return p;
  const double radius = 1.0 / angle;
  const double a = p.x() * angle;
  return {(radius + p.y()) * std::sin(a), (radius + p.y()) * std::cos(a) - radius, p.z()};
}

TEST(MovingHull, FollowsSmoothDeformation) {
  for (const Shape& shape : shapes()) {
    const MovingHull::Counts sum = expectFollows(shape, 40, [](int frame, const Vec3& p) {
      const double t = 0.02 * frame;
      const Vec3 q = bent(twisted(p, 1.5 * std::sin(t)), 0.9 * std::sin(2.0 * t)) + 0.4 * t * Vec3(p.y(), 0, 0);
      return Vec3(Eigen::AngleAxisd(t, Vec3(1, 2, 3).normalized()) * q + Vec3(t, -t, 0.0));
    });
    RecordProperty(shape.name, sum.rebuilds);
  }
}

TEST(MovingHull, RepairsMostFramesOfASmoothMotionInsteadOfRebuilding) {
  Random random(6);
  const MovingHull::Counts sum = expectFollows({"ball", ball(400, random)}, 40, [](int frame, const Vec3& p) {
    return bent(twisted(p, 0.02 * frame), 0.01 * frame);
  });
  EXPECT_EQ(sum.rebuilds, 1) << "the first frame";
  EXPECT_GT(sum.flips, 100);
  EXPECT_GT(sum.deletions, 10);
  EXPECT_GT(sum.insertions, 10);
}

TEST(MovingHull, KnowsWhetherItKeptItsFaces) {
  Random random(16);
  const Cloud points = ball(100, random);
  MovingHull hull(100);
  const std::vector<PointRow> rows = aboutTheirMean(points, kTicks);
  hull.update(rows);
  EXPECT_FALSE(hull.keptFaces()) << "the first are new";
  const std::vector<PointRow> larger = aboutTheirMean(scaled(points, Vec3(1.5, 1.2, 1.1)), kTicks);
  hull.update(larger);
  EXPECT_TRUE(hull.keptFaces());
  std::vector<PointRow> pushed = larger;
  pushed[hull.vertices()[0]] = {0.5F, 0.25F, 0.125F, 0.0F};
  hull.update(pushed);
  EXPECT_FALSE(hull.keptFaces());
}

TEST(MovingHull, SurvivesRandomJumps) {
  for (const Shape& shape : shapes()) {
    Random random(7);
    for (const double size : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0}) {
      expectFollows(shape, 6, [&](int, const Vec3& p) { return Vec3(p + size * uniformVec3(random, -1.0, 1.0)); });
    }
  }
}

TEST(MovingHull, ShrinksToFiftyTicksAndGrowsAgain) {
  for (const Shape& shape : shapes()) {
    expectFollows(shape, 31, [](int frame, const Vec3& p) {
      const Vec3 q = bent(p, 0.02 * frame);
      return Vec3(q * std::pow(10.0, -4.4 * std::sin(std::numbers::pi * frame / 30.0)));
    });
  }
}

TEST(MovingHull, GoesFlatAndComesBack) {
  for (const Shape& shape : shapes()) {
    for (const Vec3& flattened : {Vec3(1, 1, 0), Vec3(1, 0, 0), Vec3(0, 0, 0)}) {
      expectFollows(shape, 12, [&](int frame, const Vec3& p) {
        const double t = frame < 4 || frame > 7 ? 1.0 - 0.05 * frame : 0.0;
        return Vec3(p.cwiseProduct(flattened + t * (Vec3::Ones() - flattened)));
      });
    }
  }
}

TEST(MovingHull, FoldsThroughItsMirrorImage) {
  for (const Shape& shape : shapes()) {
    expectFollows(shape, 12,
                  [](int frame, const Vec3& p) { return Vec3(p.x(), p.y(), frame % 2 == 0 ? p.z() : -p.z()); });
    expectFollows(shape, 21, [](int frame, const Vec3& p) { return Vec3(p.x(), p.y(), p.z() * (1.0 - 0.1 * frame)); });
  }
}

TEST(MovingHull, FollowsPointsThatSwapPositions) {
  for (const Shape& shape : shapes()) {
    Random random(8);
    MovingHull hull(static_cast<int>(shape.points.size()));
    Cloud points = shape.points;
    for (int frame = 0; frame < 8; ++frame) {
      for (std::size_t i = points.size(); i > 1; --i) std::swap(points[i - 1], points[random() % i]);
      const std::vector<PointRow> rows = aboutTheirMean(points, kTicks);
      hull.update(rows);
      ASSERT_EQ(whatIsWrong(hull, rows), "") << shape.name << ", frame " << frame;
    }
  }
}

// Few points on a tiny grid: every kind of degeneracy, thousands of times.
TEST(MovingHull, TinyGridsHoldEveryDegenerateCase) {
  Random random(9);
  int flat = 0;
  int solid = 0;
  for (int count = 1; count <= 14; ++count) {
    MovingHull hull(count);
    for (int frame = 0; frame < 400; ++frame) {
      const int half = 1 + frame % 5;
      std::vector<PointRow> rows(static_cast<std::size_t>(count));
      for (PointRow& r : rows) {
        const auto ticks = [&] { return static_cast<float>(static_cast<int>(random() % (2 * half + 1)) - half); };
        r = {ticks(), ticks(), ticks(), 0.0F};
      }
      hull.update(rows);
      ASSERT_EQ(whatIsWrong(hull, rows), "") << count << " points, frame " << frame;
      (hull.flat() ? flat : solid) += 1;
    }
  }
  EXPECT_GT(flat, 500);
  EXPECT_GT(solid, 500);
}

// Small steps on a small grid: repairs, not rebuilds, meet ties of all kinds.
TEST(MovingHull, WandersOverASmallGrid) {
  Random random(10);
  int repaired = 0;
  for (const int half : {3, 10, 60}) {
    for (const int count : {6, 10, 20, 60}) {
      MovingHull hull(count);
      std::vector<PointRow> rows(static_cast<std::size_t>(count));
      const auto within = [&](float v) { return std::clamp(v, static_cast<float>(-half), static_cast<float>(half)); };
      const auto ticks = [&](int max) { return static_cast<float>(static_cast<int>(random() % (2 * max + 1)) - max); };
      for (PointRow& r : rows) r = {ticks(half), ticks(half), ticks(half), 0.0F};
      for (int frame = 0; frame < 250; ++frame) {
        for (PointRow& r : rows) {
          if (random() % 4 == 0) r = {within(r.x + ticks(1)), within(r.y + ticks(1)), within(r.z + ticks(1)), 0.0F};
        }
        hull.update(rows);
        ASSERT_EQ(whatIsWrong(hull, rows), "") << half << " ticks, " << count << " points, frame " << frame;
        repaired += hull.flat() || hull.counts().rebuilds == 1 ? 0 : 1;
      }
    }
  }
  EXPECT_GT(repaired, 2000);
}

// A pyramid over and under a pentagon. In the second frame its corners have rotated twice as far: every face still
// looks outwards and every edge is convex, but the surface winds around the origin twice.
TEST(MovingHull, AStarPentagonIsNotTakenForAHull) {
  const auto bipyramid = [](int step) {
    Cloud points = {Vec3(0, 0, 1), Vec3(0, 0, -1)};
    for (int i = 0; i < 5; ++i) {
      const double angle = 2.0 * std::numbers::pi * step * i / 5;
      points.emplace_back(std::cos(angle), std::sin(angle), 0.0);
    }
    return aboutTheirMean(points, kTicks);
  };
  MovingHull hull(7);
  const std::vector<PointRow> first = bipyramid(1);
  hull.update(first);
  ASSERT_EQ(whatIsWrong(hull, first), "");
  const std::vector<PointRow> second = bipyramid(2);
  hull.update(second);
  EXPECT_EQ(whatIsWrong(hull, second), "");
  EXPECT_EQ(hull.counts().turnedFaces, 0) << "no face is turned, so this check alone does not detect the defect";
  EXPECT_EQ(hull.counts().rebuilds, 1);
}

TEST(MovingHull, TheLargestCoordinatesAreStillExact) {
  constexpr float m = kMaxTicks;
  std::vector<PointRow> rows;
  for (const float x : {-m, m}) {
    for (const float y : {-m, m}) {
      for (const float z : {-m, m}) rows.push_back({x, y, z, 0.0F});
    }
  }
  for (const float x : {-1.0F, 0.0F, 1.0F}) {
    // On a face, one tick below it, and near an edge.
    rows.push_back({x, 7.0F * x, m, 0.0F});
    rows.push_back({x, 5.0F, m - 1.0F, 0.0F});
    rows.push_back({m, m - 1.0F, x, 0.0F});
  }
  MovingHull hull(static_cast<int>(rows.size()));
  hull.update(rows);
  EXPECT_EQ(whatIsWrong(hull, rows), "");
  EXPECT_EQ(hull.volume(), std::pow(2.0 * m, 3.0));
  // One tick: the corner that sinks leaves its faces' planes.
  rows[7] = {m - 1.0F, m, m, 0.0F};
  hull.update(rows);
  EXPECT_EQ(whatIsWrong(hull, rows), "");
  EXPECT_EQ(hull.counts().rebuilds, 0);
  EXPECT_LT(hull.volume(), std::pow(2.0 * m, 3.0));
}

TEST(MovingHull, SameFramesGiveTheSameFaces) {
  Random random(11);
  const Cloud rest = ball(150, random);
  MovingHull first(150), second(150);
  for (int frame = 0; frame < 30; ++frame) {
    Cloud posed = rest;
    for (Vec3& p : posed) p = bent(p, 0.05 * frame);
    const std::vector<PointRow> rows = aboutTheirMean(posed, kTicks);
    first.update(rows);
    second.update(rows);
    ASSERT_TRUE(std::ranges::equal(first.faces(), second.faces()));
    ASSERT_TRUE(std::ranges::equal(first.vertices(), second.vertices()));
  }
}

// Filters of another width or rounding leave other faces in doubt; the result must not show it.
TEST(MovingHull, EveryInstructionSetGivesTheSameFacesAndVolume) {
  const auto run = [] {
    std::vector<Triangle> all;
    std::vector<double> volumes;
    for (const Shape& shape : shapes()) {
      Random random(13);
      MovingHull hull(static_cast<int>(shape.points.size()));
      for (int frame = 0; frame < 20; ++frame) {
        Cloud posed = shape.points;
        for (Vec3& p : posed) p = bent(p, 0.03 * frame) + 1e-3 * uniformVec3(random, -1.0, 1.0);
        const std::vector<PointRow> rows = aboutTheirMean(posed, 1e4);
        hull.update(rows);
        all.insert(all.end(), hull.faces().begin(), hull.faces().end());
        volumes.push_back(hull.volume());
      }
    }
    return std::make_pair(all, volumes);
  };
  const auto first = run();
  ASSERT_GT(first.first.size(), 10000u);
  test::onEveryInstructionSet([&] { EXPECT_EQ(run(), first); });
}

}  // namespace
}  // namespace lorica::test
