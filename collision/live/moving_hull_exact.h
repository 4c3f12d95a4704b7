#pragma once

#include "collision/live/point_row.h"

#include <cmath>
#include <cstdint>

/// Exact predicates for whole coordinates of at most 2^22 in absolute value, as seen from the origin s.
///
/// Differences are exact. In double precision, products of two differences (2^46) and their differences (2^47) are
/// exact too; only the last sum of three products is rounded. If that rounding could change the sign, 128-bit integers
/// decide.
namespace lorica::exact {

struct Row {
  double x, y, z;
};

[[nodiscard]] inline Row rowOf(const PointRow& p) {
  return {p.x, p.y, p.z};
}

/// At most 2^23 in absolute value, so single precision holds it.
[[nodiscard]] inline Row between(const PointRow& from, const PointRow& to) {
  return {to.x - from.x, to.y - from.y, to.z - from.z};
}

/// Exact for coordinates up to 2^26.
[[nodiscard]] inline Row cross(const Row& u, const Row& v) {
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

/// Normal times w in 128 bits: exact.
[[nodiscard]] inline double wideDot(const Row& normal, const Row& w) {
  __extension__ using Wide = __int128;
  const auto product = [](double a, double b) {
    return static_cast<Wide>(static_cast<std::int64_t>(a)) * static_cast<std::int64_t>(b);
  };
  return product(normal.x, w.x) + product(normal.y, w.y) + product(normal.z, w.z);
}

/// Normal times w with the correct sign, including zero.
[[nodiscard]] inline double dot(const Row& normal, const Row& w) {
  const double x = normal.x * w.x;
  const double y = normal.y * w.y;
  const double z = normal.z * w.z;
  const double value = x + y + z;
  // Three products and two sums have a relative rounding error of at most 2^-53 each: 3.1 * 2^-53 of the sum of
  // absolute values.
  constexpr double kBound = 4.0 * 0x1p-53;
  if (std::abs(value) > kBound * (std::abs(x) + std::abs(y) + std::abs(z))) return value;
  return wideDot(normal, w);
}

/// det(a, b, c): the sign is exact, the value accurate to a few roundings. Positive if the triangle a, b, c is
/// counter-clockwise as seen from outside a hull that contains the origin.
[[nodiscard]] inline double det(const PointRow& a, const PointRow& b, const PointRow& c) {
  return dot(cross(rowOf(a), rowOf(b)), rowOf(c));
}

/// det(b - a, c - a, d - a), with the same accuracy: positive if d lies outside the plane of the face a, b, c.
[[nodiscard]] inline double side(const PointRow& a, const PointRow& b, const PointRow& c, const PointRow& d) {
  return dot(cross(between(a, b), between(a, c)), between(a, d));
}

}  // namespace lorica::exact
