#include "tests/skinning/humanoid/humanoid_figure.h"

#include "geometry/counts.h"
#include "geometry/random_numbers.h"
#include "skinning/mannequin/mannequin_skeleton.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>

namespace lorica::test {

int Figure::find(std::string_view name) const {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].name == name) return static_cast<int>(i);
  }
  ADD_FAILURE() << "no part " << name;
  return 0;
}

bool Figure::isBelowOrSame(int part, int ancestor) const {
  while (part != -1 && part != ancestor) part = parts[part].parent;
  return part == ancestor;
}

void Figure::bend(std::string_view name, double degrees, const Vec3& axis) {
  const int top = find(name);
  const Vec3 centre = at(name);
  const Quat turn(Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, axis.normalized()));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (isBelowOrSame(static_cast<int>(i), top)) parts[i].position = centre + turn * (parts[i].position - centre);
  }
}

void Figure::straightenLegs() {
  for (const std::string side : {"left", "right"}) {
    parts[find(side + "LowerLeg")].position = 0.5 * (at(side + "UpperLeg") + at(side + "Foot"));
  }
}

void Figure::remove(const std::function<bool(const std::string&)>& which) {
  for (std::size_t i = parts.size(); i-- > 0;) {
    if (!which(parts[i].name)) continue;
    for (Part& part : parts) {
      if (part.parent == static_cast<int>(i)) part.parent = parts[i].parent;
      if (part.parent > static_cast<int>(i)) --part.parent;
    }
    parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

void Figure::add(std::string name, std::string_view parent, const Vec3& offset) {
  parts.push_back({std::move(name), find(parent), at(parent) + offset});
}

void Figure::insertAbove(std::string_view name, double fraction) {
  const int below = find(name);
  const int above = parts[below].parent;
  const Vec3 between = (1.0 - fraction) * parts[above].position + fraction * at(name);
  parts.push_back({"extra above " + std::string(name), above, between});
  parts[below].parent = countOf(parts) - 1;
}

Figure mannequinFigure() {
  Figure figure;
  const Skeleton skeleton = makeMannequinSkeleton();
  for (const Joint& joint : skeleton.joints()) {
    figure.parts.push_back({joint.name, joint.parent, mannequinJoint(*joint.bone)});
  }
  return figure;
}

bool isFinger(const std::string& name) {
  return name.ends_with("Proximal") || name.ends_with("Intermediate") || name.ends_with("Distal") ||
         name.ends_with("Metacarpal");
}

Built build(const Figure& figure, const Affine3& worldFromFigure, std::uint64_t seed) {
  RandomNumbers random(seed);
  std::vector<int> order;
  std::vector<int> open = {-1};
  while (!open.empty()) {
    const std::size_t pick = random.bits() % open.size();
    const int part = open[pick];
    open.erase(open.begin() + static_cast<std::ptrdiff_t>(pick));
    if (part != -1) order.push_back(part);
    for (std::size_t i = 0; i < figure.parts.size(); ++i) {
      if (figure.parts[i].parent == part) open.push_back(static_cast<int>(i));
    }
  }
  std::vector<Joint> joints;
  std::vector<Affine3> worldFromJoint;
  std::map<int, JointIndex> indexOf;
  Built built{makeMannequinSkeleton(), {}};
  for (const int i : order) {
    const Figure::Part& part = figure.parts[i];
    Joint joint;
    joint.name = fmt::format("q{:x}", random.bits() % 0xffffff);
    joint.parent = part.parent == -1 ? kNoJoint : indexOf.at(part.parent);
    const Vec3 axis(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0));
    Affine3 world = Affine3::Identity();
    world.translate(worldFromFigure * part.position)
        .rotate(Eigen::AngleAxisd(random.between(-3.0, 3.0), (axis + Vec3(0, 0, 1e-3)).normalized()));
    const Affine3 local = joint.parent == kNoJoint ? world : worldFromJoint[joint.parent].inverse() * world;
    joint.rest.translation = local.translation();
    joint.rest.rotation = Quat(local.rotation()).normalized();
    if (const std::optional<HumanBone> bone = humanBoneNamed(part.name)) built.truth[*bone] = joint.name;
    indexOf[i] = static_cast<JointIndex>(joints.size());
    worldFromJoint.push_back(world);
    joints.push_back(joint);
  }
  built.skeleton = std::move(*Skeleton::create(std::move(joints)));
  return built;
}

Affine3 turned(double degrees, const Vec3& axis, double scale) {
  Affine3 turn = Affine3::Identity();
  turn.rotate(Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, axis)).scale(scale);
  return turn;
}

Figure without(Figure figure, const std::set<std::string>& names) {
  figure.remove([&](const std::string& name) { return names.contains(name); });
  return figure;
}

Figure armsAt(Figure figure, double degreesDown) {
  figure.bend("leftUpperArm", -degreesDown, Vec3::UnitZ());
  figure.bend("rightUpperArm", degreesDown, Vec3::UnitZ());
  return figure;
}

}  // namespace lorica::test
