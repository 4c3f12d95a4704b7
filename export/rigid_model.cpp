#include "export/rigid_model.h"

#include "acd/separating_plane.h"
#include "capture/retarget/proxy_skeleton.h"
#include "export/mesh_export.h"
#include "geometry/counts.h"
#include "geometry/text.h"
#include "skinning/humanoid/joint_limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <numbers>

namespace lorica {

namespace {

constexpr double kUnknownRange = std::numbers::pi / 6.0;
constexpr double kStill = 1e-6;  // a range that is no motion [rad]

std::vector<RigidHinge> hingesOf(const Joint& joint, const std::string& name) {
  std::vector<RigidHinge> hinges;
  const auto add = [&](const char* kind, const Vec3& axis, const AngleRange& range) {
    if (range.max - range.min > kStill) hinges.push_back({name + "_" + kind, axis, range.min, range.max});
  };
  if (!joint.bone) {
    const AngleRange range{-kUnknownRange, kUnknownRange};
    add("x", Vec3::UnitX(), range);
    add("y", Vec3::UnitY(), range);
    add("z", Vec3::UnitZ(), range);
    return hinges;
  }
  const JointRange& range = jointRange(*joint.bone);
  if (range.twistAtParent) add("twist", range.twistAxis, range.twist);
  add("first", range.firstAxis, range.first);
  add("second", range.secondAxis, range.second);
  if (!range.twistAtParent) add("twist", range.twistAxis, range.twist);
  return hinges;
}

/// Mass properties of the hulls together, as solids of the same density that have the given mass.
void weigh(RigidBody& body, double massPerVolume) {
  double volume = 0.0;
  Vec3 moment = Vec3::Zero();
  std::vector<MassProperties> each;
  for (const NamedMesh& hull : body.hulls) {
    each.push_back(massProperties(hull.mesh.vertices, hull.mesh.triangles));
    volume += each.back().volume;
    moment += each.back().volume * each.back().center;
  }
  body.mass = massPerVolume * volume;
  body.center = moment / volume;
  body.inertia = Mat3::Zero();
  for (const MassProperties& solid : each) {
    const Vec3 away = solid.center - body.center;
    body.inertia += massPerVolume *
                    (solid.inertia + solid.volume * (away.squaredNorm() * Mat3::Identity() - away * away.transpose()));
  }
}

bool overlap(const RigidBody& a, const RigidBody& b) {
  const auto placed = [](const RigidBody& body, const NamedMesh& hull) {
    std::vector<Vec3> points;
    for (const Vec3& p : hull.mesh.vertices) points.push_back(body.origin + p);
    return points;
  };
  for (const NamedMesh& first : a.hulls) {
    for (const NamedMesh& second : b.hulls) {
      if (!separatingPlane(placed(a, first), placed(b, second))) return true;
    }
  }
  return false;
}

void findOverlaps(RigidModel& model) {
  for (int a = 0; a < countOf(model.bodies); ++a) {
    for (int b = a + 1; b < countOf(model.bodies); ++b) {
      if (model.bodies[b].parent != a && overlap(model.bodies[a], model.bodies[b]))
        model.overlapping.emplace_back(a, b);
    }
  }
}

/// Gives bodies their unique plain names. @return how many were changed
int nameBodies(std::vector<RigidBody>& bodies) {
  std::vector<std::string> names;
  names.reserve(bodies.size());
  for (const RigidBody& body : bodies) names.push_back(body.name);
  const std::vector<std::string> plain = plainNames(names);
  int changed = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (plain[b] != bodies[b].name) ++changed;
    bodies[b].name = plain[b];
    for (std::size_t h = 0; h < bodies[b].hulls.size(); ++h)
      bodies[b].hulls[h].name = fmt::format("{}_hull_{}", plain[b], h);
  }
  return changed;
}

}  // namespace

RigidModel rigidModelOf(const Character& character, std::span<const RigidCollider> colliders) {
  const Skeleton& skeleton = character.skeleton;
  std::map<JointIndex, std::vector<const RigidCollider*>> ofJoint;
  for (const RigidCollider& collider : colliders) ofJoint[collider.joint].push_back(&collider);

  RigidModel model;
  model.name = plainNames({character.name}).front();
  std::map<JointIndex, int> bodyOf;
  int unknown = 0;
  double volume = 0.0;
  const std::vector<JointIndex> parents = parentsOf(character);
  const std::function<void(JointIndex)> add = [&](JointIndex joint) {
    if (bodyOf.contains(joint)) return;
    JointIndex above = parents[joint];
    while (above != kNoJoint && !ofJoint.contains(above)) above = parents[above];
    if (above != kNoJoint) add(above);
    RigidBody body;
    body.name = skeleton.joint(joint).name;
    body.joint = joint;
    body.origin = character.jointFromModel[joint].inverse().translation();
    // Without a bone above it that has hulls, a body hangs on the first one, so that all stay together.
    body.parent = above != kNoJoint ? bodyOf.at(above) : model.bodies.empty() ? -1 : 0;
    for (const RigidCollider* collider : ofJoint.at(joint)) {
      NamedMesh hull{"", collider->hull};
      for (Vec3& p : hull.mesh.vertices) p -= body.origin;
      body.hulls.push_back(std::move(hull));
      volume += collider->volume;
    }
    bodyOf[joint] = countOf(model.bodies);
    model.bodies.push_back(std::move(body));
  };
  for (const auto& [joint, own] : ofJoint) add(joint);
  const int renamed = nameBodies(model.bodies);
  const double mass = kDensity * signedVolume(character.mesh.vertices, character.mesh.triangles);
  for (RigidBody& body : model.bodies) {
    weigh(body, mass / volume);
    if (body.parent < 0) continue;
    const Joint& joint = skeleton.joint(*body.joint);
    body.hinges = hingesOf(joint, body.name);
    if (!joint.bone) ++unknown;
  }
  findOverlaps(model);
  if (renamed > 0) {
    model.notes.push_back(counted(renamed, "of the bones' names was", "of the bones' names were") +
                          " changed to letters, digits and _-., each used once");
  }
  if (unknown > 0) {
    model.notes.push_back(
        counted(unknown, "of the joints is no human bone: it turns", "of the joints are no human bone: they turn") +
        " by 30 degrees to each side");
  }
  return model;
}

RigidModel rigidModelOf(const std::string& name, const TriMesh& mesh, std::vector<NamedMesh> hulls) {
  RigidModel model;
  model.name = plainNames({name}).front();
  RigidBody body;
  body.name = model.name;
  body.hulls = std::move(hulls);
  const MassProperties solid = massProperties(mesh.vertices, mesh.triangles);
  body.mass = kDensity * solid.volume;
  body.center = solid.center;
  body.inertia = kDensity * solid.inertia;
  model.bodies.push_back(std::move(body));
  (void)nameBodies(model.bodies);
  return model;
}

Mat3 zUp(const Mat3& inertia) {
  Mat3 turn;
  turn << 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0;
  return turn * inertia * turn.transpose();
}

}  // namespace lorica
