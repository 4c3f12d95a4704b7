#include "acd/cap.h"

#include "geometry/counts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>

namespace lorica {
namespace {

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
