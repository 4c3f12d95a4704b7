#include "acd/support.h"

#include "geometry/math.h"

// Highway compiles the code between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "acd/support.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef LORICA_ACD_SUPPORT_DIRECTIONS
#define LORICA_ACD_SUPPORT_DIRECTIONS
namespace lorica {

/// One direction of each pair, by coordinate.
struct alignas(64) SupportDirections {
  std::array<float, Support::kPairs> x, y, z;
};

}  // namespace lorica
#endif

HWY_BEFORE_NAMESPACE();
namespace lorica::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;  // 16 and all smaller powers of two divide the number of pairs
using Ints = hn::RebindToSigned<Floats>;

void includeSupport(Support& into, const Support& other) {
  const Floats f;
  const Ints n;
  for (std::size_t i = 0; i < Support::kPairs; i += hn::Lanes(f)) {
    const auto high = hn::Load(f, into.high.data() + i);
    const auto otherHigh = hn::Load(f, other.high.data() + i);
    const auto higher = hn::Gt(otherHigh, high);
    hn::Store(hn::IfThenElse(higher, otherHigh, high), f, into.high.data() + i);
    hn::Store(hn::IfThenElse(hn::RebindMask(n, higher), hn::Load(n, other.highest.data() + i),
                             hn::Load(n, into.highest.data() + i)),
              n, into.highest.data() + i);
    const auto low = hn::Load(f, into.low.data() + i);
    const auto otherLow = hn::Load(f, other.low.data() + i);
    const auto lower = hn::Lt(otherLow, low);
    hn::Store(hn::IfThenElse(lower, otherLow, low), f, into.low.data() + i);
    hn::Store(hn::IfThenElse(hn::RebindMask(n, lower), hn::Load(n, other.lowest.data() + i),
                             hn::Load(n, into.lowest.data() + i)),
              n, into.lowest.data() + i);
  }
}

void includePoints(Support& into, const SupportDirections& directions, const FloatPoints& points,
                   std::span<const std::int32_t> ids, std::int32_t first, const Support* bound) {
  const Floats f;
  const Ints n;
  for (std::size_t i = 0; i < Support::kPairs; i += hn::Lanes(f)) {
    auto high = hn::Load(f, into.high.data() + i);
    auto low = hn::Load(f, into.low.data() + i);
    if (bound != nullptr && hn::AllFalse(f, hn::Gt(hn::Load(f, bound->high.data() + i), high)) &&
        hn::AllFalse(f, hn::Lt(hn::Load(f, bound->low.data() + i), low))) {
      continue;
    }
    auto highest = hn::Load(n, into.highest.data() + i);
    auto lowest = hn::Load(n, into.lowest.data() + i);
    const auto x = hn::Load(f, directions.x.data() + i);
    const auto y = hn::Load(f, directions.y.data() + i);
    const auto z = hn::Load(f, directions.z.data() + i);
    for (const std::int32_t id : ids) {
      const std::size_t p = id;
      // No fused multiply-add, so that every instruction set rounds the same way.
      const auto value = hn::Add(hn::Add(hn::Mul(x, hn::Set(f, points.x[p])), hn::Mul(y, hn::Set(f, points.y[p]))),
                                 hn::Mul(z, hn::Set(f, points.z[p])));
      const auto name = hn::Set(n, first + id);
      const auto higher = hn::Gt(value, high);
      const auto lower = hn::Lt(value, low);
      high = hn::IfThenElse(higher, value, high);
      low = hn::IfThenElse(lower, value, low);
      highest = hn::IfThenElse(hn::RebindMask(n, higher), name, highest);
      lowest = hn::IfThenElse(hn::RebindMask(n, lower), name, lowest);
    }
    hn::Store(high, f, into.high.data() + i);
    hn::Store(low, f, into.low.data() + i);
    hn::Store(highest, n, into.highest.data() + i);
    hn::Store(lowest, n, into.lowest.data() + i);
  }
}

}  // namespace lorica::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <cmath>
#include <limits>
#include <map>

namespace lorica {
namespace {

HWY_EXPORT(includeSupport);
HWY_EXPORT(includePoints);

/// An icosahedron with its edges divided in three, projected to the sphere: the directions, and the triangles between
/// them as slots (i: positive direction of pair i; kPairs + i: negative direction).
struct Sphere {
  SupportDirections directions;
  std::vector<std::array<std::uint8_t, 3>> triangles;
};

Sphere makeSphere() {
  constexpr int kCuts = 3;
  const double golden = 0.5 * (1.0 + std::sqrt(5.0));
  std::vector<Vec3> corners;
  for (const double a : {1.0, -1.0}) {
    for (const double b : {golden, -golden}) {
      corners.insert(corners.end(), {Vec3(0, a, b), Vec3(a, b, 0), Vec3(b, 0, a)});
    }
  }
  Sphere sphere;
  std::map<std::array<int, 3>, std::uint8_t> slotOf;
  std::uint8_t pairs = 0;
  const auto slot = [&](const Vec3& direction) {
    // Three digits distinguish the grid points, and are insensitive to rounding errors.
    const auto key = [](const Vec3& d) {
      return std::array<int, 3>{static_cast<int>(std::lround(d.x() * 1000)),
                                static_cast<int>(std::lround(d.y() * 1000)),
                                static_cast<int>(std::lround(d.z() * 1000))};
    };
    const auto known = slotOf.find(key(direction));
    if (known != slotOf.end()) return known->second;
    sphere.directions.x[pairs] = direction.x();
    sphere.directions.y[pairs] = direction.y();
    sphere.directions.z[pairs] = direction.z();
    slotOf[key(direction)] = pairs;
    slotOf[key(-direction)] = Support::kPairs + pairs;
    return pairs++;
  };
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (std::size_t j = i + 1; j < corners.size(); ++j) {
      for (std::size_t k = j + 1; k < corners.size(); ++k) {
        // Corners of a face are one edge length, 2, apart.
        const auto edge = [&](std::size_t m, std::size_t n) { return (corners[m] - corners[n]).norm() < 2.1; };
        if (!edge(i, j) || !edge(j, k) || !edge(k, i)) continue;
        const bool outward = corners[i].dot(corners[j].cross(corners[k])) > 0.0;
        const Vec3 a = corners[i];
        const Vec3 u = (corners[outward ? j : k] - a) / kCuts;
        const Vec3 v = (corners[outward ? k : j] - a) / kCuts;
        const auto at = [&](int s, int t) { return slot((a + s * u + t * v).normalized()); };
        for (int s = 0; s < kCuts; ++s) {
          for (int t = 0; s + t < kCuts; ++t) {
            sphere.triangles.push_back({at(s, t), at(s + 1, t), at(s, t + 1)});
            if (s + t + 1 < kCuts) sphere.triangles.push_back({at(s + 1, t), at(s + 1, t + 1), at(s, t + 1)});
          }
        }
      }
    }
  }
  for (std::size_t i = pairs; i < Support::kPairs; ++i) {
    sphere.directions.x[i] = sphere.directions.x[0];
    sphere.directions.y[i] = sphere.directions.y[0];
    sphere.directions.z[i] = sphere.directions.z[0];
  }
  return sphere;
}

const Sphere& sphere() {
  static const Sphere made = makeSphere();
  return made;
}

}  // namespace

void FloatPoints::resize(std::size_t count) {
  x.resize(count);
  y.resize(count);
  z.resize(count);
}

void Support::clear() {
  high.fill(-std::numeric_limits<float>::infinity());
  low.fill(std::numeric_limits<float>::infinity());
  highest.fill(0);
  lowest.fill(0);
}

void include(Support& into, const Support& other) {
  HWY_DYNAMIC_DISPATCH(includeSupport)(into, other);
}

void include(Support& into, const FloatPoints& points, std::span<const std::int32_t> ids, std::int32_t first,
             const Support* bound) {
  HWY_DYNAMIC_DISPATCH(includePoints)(into, sphere().directions, points, ids, first, bound);
}

double enclosedVolume(const Support& support, const FloatPoints& points, const FloatPoints& more) {
  std::array<std::array<float, 3>, 2 * Support::kPairs> corner;
  const auto fetch = [&](std::int32_t id) {
    std::size_t i = id;
    const FloatPoints& from = i < points.size() ? points : more;
    if (i >= points.size()) i -= points.size();
    return std::array<float, 3>{from.x[i], from.y[i], from.z[i]};
  };
  for (std::size_t i = 0; i < Support::kPairs; ++i) {
    corner[i] = fetch(support.highest[i]);
    corner[Support::kPairs + i] = fetch(support.lowest[i]);
  }
  const std::array<float, 3> origin = corner[0];
  for (std::array<float, 3>& c : corner) {
    for (std::size_t axis = 0; axis < 3; ++axis) c[axis] -= origin[axis];
  }
  double sum = 0.0;
  for (const std::array<std::uint8_t, 3>& t : sphere().triangles) {
    const auto& a = corner[t[0]];
    const auto& b = corner[t[1]];
    const auto& c = corner[t[2]];
    sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum / 6.0;
}

}  // namespace lorica
#endif
