#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// Points as arrays of their coordinates, in single precision.
struct FloatPoints {
  std::vector<float> x, y, z;

  void resize(std::size_t count);
  [[nodiscard]] std::size_t size() const { return x.size(); }
};

/// The support points of a set in 92 directions, distributed evenly over the sphere in 46 opposite pairs: a hull's
/// shape in a fixed number of bytes. The support of a union is computed from the supports of its members, without their
/// points.
///
/// Identical on every machine: vector instructions of any width give the same rounding.
struct alignas(64) Support {
  static constexpr std::size_t kPairs = 48;  ///< 46, plus two duplicates to fill SIMD vectors

  std::array<float, kPairs> high, low;               ///< largest and smallest coordinate along each pair
  std::array<std::int32_t, kPairs> highest, lowest;  ///< ids of the points at these coordinates

  void clear();
};

/// Adds another set: computes the support of the union.
void include(Support& into, const Support& other);

/// Adds points to the set.
/// @param ids    indices of the points to add
/// @param first  offset added to an id before it is stored
/// @param bound  support of a set whose hull contains all these points, or null: directions in which it is not beyond
///               `into` are skipped
void include(Support& into, const FloatPoints& points, std::span<const std::int32_t> ids, std::int32_t first,
             const Support* bound);

/// Volume enclosed by the support points, connected like their directions on the sphere. At most the hull's volume
/// except for rare folds: 6 % less for a sphere, exact for a box.
/// @param points  points with ids below points.size()
/// @param more    points with larger ids
[[nodiscard]] double enclosedVolume(const Support& support, const FloatPoints& points, const FloatPoints& more);

}  // namespace lorica
