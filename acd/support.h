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

/// The extreme points of a set in 92 directions that are spread evenly over the sphere in 46 opposite pairs: a hull's
/// shape in a fixed number of bytes. Those of a union come from those of its members, without looking at any point.
///
/// The same on every machine: vector instructions of any width compare the same roundings.
struct alignas(64) Support {
  static constexpr std::size_t kPairs = 48;  ///< 46, and two repeated to fill vectors

  std::array<float, kPairs> high, low;               ///< largest and smallest coordinate along each pair
  std::array<std::int32_t, kPairs> highest, lowest;  ///< ids of the points that have them

  void clear();
};

/// Takes the extremes of another set into account.
void include(Support& into, const Support& other);

/// Takes points into account.
/// @param ids    which of `points`
/// @param first  what is added to an id before it is stored
/// @param bound  a set whose hull holds them all, or null: directions in which it stays behind are not looked at
void include(Support& into, const FloatPoints& points, std::span<const std::int32_t> ids, std::int32_t first,
             const Support* bound);

/// Volume inside the closed surface through the extreme points, connected as their directions are on the sphere. At
/// most the hull's volume but for rare folds: 6 % less for a sphere, exact for a box.
/// @param points  ids below points.size()
/// @param more    ids from there on
[[nodiscard]] double enclosedVolume(const Support& support, const FloatPoints& points, const FloatPoints& more);

}  // namespace lorica
