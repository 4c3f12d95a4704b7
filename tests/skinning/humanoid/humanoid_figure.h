#pragma once

#include "skinning/skeleton.h"

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace lorica::test {

/// Positions and hierarchy of joints; the tests bend and change bodies in this form.
struct Figure {
  struct Part {
    std::string name;  ///< the bone's, or a meaningless one
    int parent = -1;
    Vec3 position = Vec3::Zero();
  };
  std::vector<Part> parts;

  [[nodiscard]] int find(std::string_view name) const;
  [[nodiscard]] bool isBelowOrSame(int part, int ancestor) const;
  [[nodiscard]] Vec3 at(std::string_view name) const { return parts[find(name)].position; }

  /// Rotates a part and everything below about it.
  void bend(std::string_view name, double degrees, const Vec3& axis);
  void straightenLegs();
  void remove(const std::function<bool(const std::string&)>& which);
  void add(std::string name, std::string_view parent, const Vec3& offset);
  /// Inserts a joint between a part and its parent.
  void insertAbove(std::string_view name, double fraction);
};

/// The mannequin's joints, named by their bones.
[[nodiscard]] Figure mannequinFigure();

[[nodiscard]] bool isFinger(const std::string& name);

struct Built {
  Skeleton skeleton;
  std::map<HumanBone, std::string> truth;
};

/// The figure as a skeleton with meaningless names, another order of siblings and rotated joint axes.
[[nodiscard]] Built build(const Figure& figure, const Affine3& worldFromFigure, std::uint64_t seed);

[[nodiscard]] Affine3 turned(double degrees, const Vec3& axis, double scale = 1.0);

[[nodiscard]] Figure without(Figure figure, const std::set<std::string>& names);

[[nodiscard]] Figure armsAt(Figure figure, double degreesDown);

}  // namespace lorica::test
