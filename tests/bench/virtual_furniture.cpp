#include "tests/bench/virtual_furniture.h"

#include "geometry/counts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lorica {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// Builds a piece from simple surfaces, with measures drawn at random.
class Builder {
 public:
  explicit Builder(RandomNumbers& random) : random_(random) {}

  double between(double min, double max) { return random_.between(min, max); }
  bool happens(double probability) { return random_.unit() < probability; }
  int below(int count) { return static_cast<int>(random_.unit() * count); }
  /// Around zero, like a normal deviate.
  double around(double spread) {
    return spread * (random_.unit() + random_.unit() + random_.unit() + random_.unit() - 2.0) * std::numbers::sqrt3;
  }
  Vec3 direction() { return Vec3{around(1.0), around(1.0), around(1.0) + 1e-6}.normalized(); }

  void quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const int first = countOf(piece_.positions);
    piece_.positions.insert(piece_.positions.end(), {a, b, c, d});
    piece_.triangles.push_back({first, first + 1, first + 2});
    piece_.triangles.push_back({first, first + 2, first + 3});
  }

  void box(const Vec3& min, const Vec3& max) {
    constexpr std::array<std::array<int, 4>, 6> kSides = {
        {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
    const auto corner = [&](int i) {
      return Vec3((i & 1) != 0 ? max.x() : min.x(), (i & 2) != 0 ? max.y() : min.y(), (i & 4) != 0 ? max.z() : min.z());
    };
    for (const auto& side : kSides) quad(corner(side[0]), corner(side[1]), corner(side[2]), corner(side[3]));
  }

  /// A superellipsoid. @param roundness  0 = box, 1 = ellipsoid; @param bumps  share of the radius
  void blob(const Vec3& middle, const Vec3& radius, double roundness, double bumps) {
    constexpr int kAround = 18, kUp = 10;
    const int first = countOf(piece_.positions);
    const double phase = between(0.0, 6.0), waves = between(1.0, 4.0);
    const auto power = [&](double x) { return std::copysign(std::pow(std::abs(x), roundness), x); };
    for (int row = 0; row <= kUp; ++row) {
      const double up = std::numbers::pi * (static_cast<double>(row) / kUp - 0.5);
      for (int column = 0; column <= kAround; ++column) {
        const double turn = kTurn * column / kAround;
        const double grown = 1.0 + bumps * std::sin(waves * turn + phase) * std::cos(up);
        const double ring = power(std::cos(up));
        const Vec3 unit(ring * power(std::cos(turn)), power(std::sin(up)), ring * power(std::sin(turn)));
        piece_.positions.emplace_back(middle + grown * radius.cwiseProduct(unit));
      }
    }
    for (int row = 0; row < kUp; ++row) {
      for (int column = 0; column < kAround; ++column) {
        const int i = first + row * (kAround + 1) + column;
        piece_.triangles.push_back({i, i + 1, i + kAround + 2});
        piece_.triangles.push_back({i, i + kAround + 2, i + kAround + 1});
      }
    }
  }

  /// A cushion within a box.
  void cushion(const Vec3& min, const Vec3& max) {
    const double roundness = between(0.15, 0.4), bumps = between(0.0, 0.03);
    blob(0.5 * (min + max), 0.5 * (max - min), roundness, bumps);
  }
  void cushionOrBox(bool soft, const Vec3& min, const Vec3& max) { soft ? cushion(min, max) : box(min, max); }

  void rod(const Vec3& a, const Vec3& b, double radiusA, double radiusB) {
    constexpr int kSides = 8;
    const Vec3 along = (b - a).normalized(), first = along.unitOrthogonal(), second = along.cross(first);
    const auto aside = [&](int i) {
      const double turn = kTurn * i / kSides;
      return Vec3(std::cos(turn) * first + std::sin(turn) * second);
    };
    for (int i = 0; i < kSides; ++i) {
      const Vec3 x = aside(i), y = aside(i + 1);
      quad(a + radiusA * x, a + radiusA * y, b + radiusB * y, b + radiusB * x);
    }
  }

  /// Things that stand on a board.
  void clutter(double height, double halfWidth, double halfDepth, int count) {
    for (int i = 0; i < count; ++i) {
      const Vec3 at{between(-halfWidth, halfWidth), height, between(-halfDepth, halfDepth)};
      const double up = between(0.03, 0.4), r = between(0.02, 0.18);
      if (happens(0.5)) {
        const double deep = r * between(0.3, 1.0);
        box(at - Vec3(r, 0.0, deep), at + Vec3(r, up, deep));
      } else if (happens(0.6)) {
        rod(at, at + Vec3(0.0, up, 0.0), 0.5 * r, 0.5 * r * between(0.6, 1.2));
      } else {
        blob(at + Vec3(0.0, 0.5 * up, 0.0), {0.6 * r, 0.5 * up, 0.6 * r}, between(0.5, 1.0), 0.1);
      }
    }
  }

  /// Four legs at the corners of a board.
  void legs(double halfWidth, double halfDepth, double height, double radius) {
    const bool square = happens(0.5);
    for (const double x : {-halfWidth, halfWidth}) {
      for (const double z : {-halfDepth, halfDepth}) {
        if (square) {
          box({x - radius, 0.0, z - radius}, {x + radius, height, z + radius});
        } else {
          rod({x, 0.0, z}, {x, height, z}, 0.8 * radius, radius);
        }
      }
    }
  }

  Furniture take(const Vec3& half) {
    piece_.half = half;
    return std::move(piece_);
  }

 private:
  RandomNumbers& random_;
  Furniture piece_;
};

Furniture table(Builder b) {
  const double w = b.between(0.3, 0.9), d = b.between(0.25, 0.55), h = b.between(0.4, 0.95);
  const double thick = b.between(0.015, 0.06);
  b.box({-w, h - thick, -d}, {w, h, d});
  b.legs(w - 0.06, d - 0.06, h - thick, b.between(0.015, 0.05));
  if (b.happens(0.3)) b.box({-w + 0.05, 0.0, -d + 0.05}, {-w + 0.45, h - thick, d - 0.05});
  if (b.happens(0.6)) b.clutter(h, w, d, 1 + b.below(7));
  return b.take({w, h, d});
}

Furniture chair(Builder b) {
  const double w = b.between(0.19, 0.28), d = b.between(0.19, 0.28), seat = b.between(0.4, 0.5);
  const double top = b.between(0.78, 1.15), thick = b.between(0.02, 0.07), leg = b.between(0.012, 0.03);
  b.cushionOrBox(b.happens(0.5), {-w, seat - 1.5 * thick, -d}, {w, seat, d});
  const Vec3 low(0.0, seat, -d), high(0.0, top, -d - b.between(0.0, 0.12)), aside(w, 0.0, 0.0);
  if (b.happens(0.6)) {
    for (const double behind : {0.0, thick}) {
      const Vec3 back(0.0, 0.0, -behind);
      b.quad(low + back - aside, low + back + aside, high + back + aside, high + back - aside);
    }
  } else {
    const int count = 2 + b.below(5);
    for (int i = 0; i < count; ++i) {
      const Vec3 x(-w + 2.0 * w * i / (count - 1), 0.0, 0.0);
      b.rod(low + x, high + x, leg, leg);
    }
    b.rod(high - aside, high + aside, 2.0 * leg, 2.0 * leg);
  }
  if (b.happens(0.35)) {  // an office chair
    b.rod({0.0, 0.1, 0.0}, {0.0, seat - thick, 0.0}, 0.03, 0.03);
    for (int i = 0; i < 5; ++i) {
      const double turn = kTurn * i / 5;
      b.rod({0.0, 0.1, 0.0}, {0.3 * std::cos(turn), 0.05, 0.3 * std::sin(turn)}, 0.025, 0.02);
    }
  } else {
    b.legs(w - leg, d - leg, seat - thick, leg);
  }
  if (b.happens(0.4)) {
    const double rest = seat + b.between(0.18, 0.28), front = d * b.between(0.5, 1.0);
    for (const double x : {-w - 0.03, w + 0.03}) {
      b.box({x - 0.03, rest, -d}, {x + 0.03, rest + 0.04, front});
      b.rod({x, seat - thick, 0.6 * d}, {x, rest, 0.6 * d}, 1.2 * leg, leg);
    }
  }
  if (b.happens(0.2)) b.blob(high + Vec3(b.around(0.05), -0.15, -0.02), {1.1 * w, 0.25, 0.08}, 0.7, 0.1);
  return b.take({w + 0.05, top, d + 0.08});
}

Furniture seats(Builder b, double minWidth, double maxWidth) {
  const double w = b.between(minWidth, maxWidth), d = b.between(0.38, 0.5), seat = b.between(0.36, 0.48);
  const double top = b.between(0.7, 1.05), rest = b.between(0.5, 0.72), thick = b.between(0.1, 0.22);
  const bool soft = b.happens(0.6);
  b.cushionOrBox(soft, {-w, 0.04, -d}, {w, seat, d});
  b.cushionOrBox(soft, {-w, 0.1, -d - 0.5 * thick}, {w, top, -d + thick});
  for (const double x : {-w, w}) b.cushionOrBox(soft, {x - 0.6 * thick, 0.03, -d}, {x + 0.6 * thick, rest, d});
  for (int i = b.below(4); i > 0; --i) {
    const Vec3 at{0.8 * b.between(-w, w), seat + 0.17, -d + thick + b.between(0.05, 0.2)};
    b.blob(at, {0.22, 0.2, b.between(0.05, 0.12)}, 0.6, 0.05);
  }
  return b.take({w + 0.6 * thick, top, d + 0.5 * thick});
}

Furniture armchair(Builder b) {
  return seats(b, 0.35, 0.5);
}

Furniture sofa(Builder b) {
  return seats(b, 0.65, 1.2);
}

Furniture shelf(Builder b) {
  const double w = b.between(0.25, 0.8), d = b.between(0.12, 0.25), h = b.between(0.7, 2.2), thick = 0.02;
  const int boards = 2 + b.below(5);
  b.box({-w, 0.0, -d}, {-w + thick, h, d});
  b.box({w - thick, 0.0, -d}, {w, h, d});
  if (b.happens(0.7)) b.box({-w, 0.0, -d}, {w, h, -d + 0.01});
  for (int i = 0; i <= boards; ++i) {
    const double y = (h - thick) * i / boards;
    b.box({-w, y, -d}, {w, y + thick, d});
    if (i == boards && b.happens(0.5)) continue;
    for (int books = b.below(6); books > 0; --books) {
      const double x = b.between(-w, 0.9 * w), width = b.between(0.02, 0.15);
      const double back = -d * b.between(0.0, 1.0), top = y + b.between(0.1, 0.95) * h / boards;
      b.box({x, y, back}, {std::min(w, x + width), top, d * b.between(0.2, 1.0)});
    }
  }
  return b.take({w, h, d});
}

Furniture cupboard(Builder b) {
  const double w = b.between(0.2, 1.2), d = b.between(0.2, 0.4), h = b.between(0.4, 2.2);
  b.box({-w, 0.0, -d}, {w, h, d});
  if (b.happens(0.5)) b.clutter(h, w, d, 1 + b.below(6));
  return b.take({w, h, d});
}

Furniture plant(Builder b) {
  const double pot = b.between(0.1, 0.22), rim = b.between(0.15, 0.4), h = b.between(0.4, 1.9);
  const double spread = b.between(0.12, 0.45), leaf = b.between(0.03, 0.12);
  b.rod(Vec3::Zero(), {0.0, rim, 0.0}, 0.8 * pot, pot);
  b.rod({0.0, rim, 0.0}, {0.0, std::max(0.8 * h, rim + 0.05), 0.0}, 0.015, 0.01);
  for (int leaves = 25 + b.below(120); leaves > 0; --leaves) {
    const Vec3 at{b.around(spread), b.between(rim, std::max(rim, h)), b.around(spread)};
    const Vec3 along = leaf * b.direction(), across = leaf * b.between(0.2, 0.6) * along.unitOrthogonal();
    b.quad(at - along, at - across, at + along, at + across);
  }
  return b.take({spread, h, spread});
}

/// Also lamps; with a coat and a hat it looks like a person.
Furniture coatStand(Builder b) {
  const double h = b.between(1.2, 1.9);
  b.rod(Vec3::Zero(), {0.0, h, 0.0}, 0.015, 0.015);
  b.rod(Vec3::Zero(), {0.0, 0.03, 0.0}, 0.18, 0.15);
  if (b.happens(0.5)) {
    const double wide = b.between(0.12, 0.25);
    b.rod({0.0, h - 0.15, 0.0}, {0.0, h + 0.12, 0.0}, wide, b.between(0.06, 0.16));
  } else {
    for (int coats = 1 + b.below(4); coats > 0; --coats) {
      const Vec3 at{b.around(0.12), h - b.between(0.3, 0.6), b.around(0.12)};
      const Vec3 radius{b.between(0.1, 0.25), b.between(0.25, 0.5), b.between(0.06, 0.14)};
      b.blob(at, radius, b.between(0.6, 1.0), 0.15);
    }
    if (b.happens(0.5)) b.blob({0.0, h + 0.05, 0.0}, {0.12, 0.1, 0.12}, 1.0, 0.05);
  }
  return b.take({0.25, h, 0.25});
}

Furniture bed(Builder b) {
  const double w = b.between(0.45, 0.9), d = b.between(0.95, 1.1), h = b.between(0.35, 0.6);
  b.box({-w, 0.1, -d}, {w, h - 0.15, d});
  b.cushion({-w, h - 0.25, -d}, {w, h, d});
  if (b.happens(0.7)) b.box({-w, 0.0, -d - 0.05}, {w, b.between(0.6, 1.1), -d});
  for (int pillows = b.below(4); pillows > 0; --pillows) {
    b.blob({0.7 * b.between(-w, w), h + 0.05, -d + 0.3}, {0.35, 0.1, 0.2}, 0.6, 0.05);
  }
  if (b.happens(0.5)) {
    const Vec3 at{b.around(0.2), h, b.around(0.4)};
    b.blob(at, {w * b.between(0.5, 1.0), b.between(0.05, 0.15), b.between(0.3, 0.8)}, 0.8, 0.2);
  }
  return b.take({w, h, d});
}

Furniture curtain(Builder b) {
  constexpr int kStrips = 60;
  const double w = b.between(0.3, 1.2), h = b.between(1.4, 2.5), deep = b.between(0.02, 0.08);
  const double waves = b.between(15.0, 45.0);
  const auto at = [&](int i, double y) {
    const double x = -w + 2.0 * w * i / kStrips;
    return Vec3(x, y, deep * std::sin(waves * x) * (y > 1.0 ? 0.8 : 1.0));
  };
  for (int i = 0; i < kStrips; ++i) b.quad(at(i, 0.02), at(i + 1, 0.02), at(i + 1, h), at(i, h));
  return b.take({w, h, deep + 0.02});
}

Furniture doorFrame(Builder b) {
  const double w = b.between(0.35, 0.5), h = b.between(1.95, 2.1);
  b.box({-w - 0.1, 0.0, -0.06}, {-w, h, 0.06});
  b.box({w, 0.0, -0.06}, {w + 0.1, h, 0.06});
  b.box({-w - 0.1, h, -0.06}, {w + 0.1, h + 0.1, 0.06});
  if (b.happens(0.5)) b.box({-w, 0.0, 0.0}, {-w + 0.04, h, 2.0 * w});
  return b.take({w + 0.1, h, 0.1});
}

Furniture heap(Builder b) {
  switch (b.below(4)) {
    case 0: {
      const double r = b.between(0.25, 0.4);
      b.blob({0.0, r, 0.0}, {r, r, r}, 1.0, 0.02);
      return b.take({r, 2.0 * r, r});
    }
    case 1: {
      const double r = b.between(0.05, 0.1);
      b.rod(Vec3::Zero(), {0.0, 2.4, 0.0}, r, r * b.between(0.8, 1.5));
      return b.take({r, 2.4, r});
    }
    case 2:
      b.rod({0.0, 0.4, 0.0}, {0.0, 0.47, 0.0}, 0.18, 0.18);
      b.box({-0.13, 0.44, -0.13}, {0.13, 0.47, 0.13});
      for (int i = 0; i < 3; ++i) {
        const Vec3 out(std::cos(kTurn * i / 3), 0.0, std::sin(kTurn * i / 3));
        b.rod(0.2 * out, 0.1 * out + Vec3(0.0, 0.4, 0.0), 0.02, 0.02);
      }
      return b.take({0.2, 0.47, 0.2});
    default:
      for (int i = 0; i < 6; ++i) {
        const Vec3 at{b.around(0.15), b.between(0.05, 0.5), b.around(0.15)};
        const Vec3 radius{b.between(0.08, 0.3), b.between(0.06, 0.2), b.between(0.08, 0.3)};
        b.blob(at, radius, b.between(0.4, 1.0), 0.15);
      }
      return b.take({0.35, 0.6, 0.35});
  }
}

Furniture desk(Builder b) {
  const double w = b.between(0.5, 0.8), d = b.between(0.3, 0.4), h = b.between(0.7, 0.78);
  const double screen = b.between(0.2, 0.35);
  b.box({-w, h - 0.03, -d}, {w, h, d});
  b.box({-w, 0.0, -d}, {-w + 0.03, h, d});
  b.box({w - (b.happens(0.5) ? 0.4 : 0.03), 0.0, -d}, {w, h, d});
  b.box({-screen, h + 0.1, -0.1}, {screen, h + 0.1 + 1.2 * screen, -0.07});
  b.rod({0.0, h, -0.1}, {0.0, h + 0.12, -0.1}, 0.03, 0.03);
  b.box({-0.22, h, 0.1}, {0.22, h + 0.02, 0.25});
  b.clutter(h, w, d, b.below(5));
  return b.take({w, h + 0.1 + 1.2 * screen, d});
}

}  // namespace

void Furniture::place(const Vec3& at, double yaw) {
  const Quat turn(Eigen::AngleAxisd(yaw, Vec3::UnitY()));
  for (Vec3& position : positions) position = at + turn * position;
}

void Furniture::draw(const Isometry3& cameraFromWorld, DepthRenderer& renderer) const {
  std::vector<Vec3> seen(positions.size());
  std::ranges::transform(positions, seen.begin(), [&](const Vec3& position) { return cameraFromWorld * position; });
  renderer.draw(seen, triangles, SurfaceSides::kBoth, 0);
}

Furniture makeFurniture(FurnitureKind kind, RandomNumbers& random) {
  constexpr std::array<Furniture (*)(Builder), kFurnitureKindCount> kMakers = {
      table, chair, armchair, sofa, shelf, cupboard, plant, coatStand, bed, curtain, doorFrame, heap, desk};
  return kMakers[static_cast<std::size_t>(kind)](Builder(random));
}

Furniture makeSeat(double height, RandomNumbers& random) {
  Builder b(random);
  const bool soft = b.happens(0.5), full = b.happens(0.5), wheels = b.happens(0.1);
  const double back = b.between(0.14, 0.35), front = b.between(0.15, 0.35);
  const double w = wheels ? b.between(0.2, 0.26) : b.between(0.22, 0.9);
  b.cushionOrBox(soft, {-w, full && !wheels ? 0.0 : height - 0.06, -back}, {w, height, front});
  if (wheels) {
    for (const double x : {-w - 0.05, w + 0.05}) {
      const Vec3 axle(x, 0.3, -0.5 * back);
      b.rod(axle - Vec3(0.015, 0.0, 0.0), axle + Vec3(0.015, 0.0, 0.0), 0.3, 0.3);
      for (int i = 0; i < 8; ++i) {  // spokes
        b.rod(axle, axle + 0.3 * Vec3(0.0, std::cos(kTurn * i / 8), std::sin(kTurn * i / 8)), 0.01, 0.03);
      }
      b.rod({x, height, -back}, {x, height + 0.5, -back - 0.05}, 0.015, 0.015);
    }
  } else if (!full) {
    b.legs(w - 0.02, 0.5 * (back + front) - 0.02, height - 0.03, 0.02);
  }
  if (wheels || b.happens(0.8)) {
    const double thick = b.between(0.03, 0.2), top = height + b.between(0.3, 0.75);
    b.cushionOrBox(soft, {-w, height - 0.1, -back - thick}, {w, top, -back});
  }
  if (wheels || b.happens(0.5)) {
    const double rest = height + b.between(0.15, 0.28), wide = full ? 0.08 : 0.03;
    for (const double x : {-w, w}) b.box({x - wide, full ? 0.0 : rest - 0.04, -back}, {x + wide, rest, front});
  }
  return b.take({w, height + 0.75, std::max(back, front)});
}

}  // namespace lorica
