#pragma once

#include "export/rigid_colliders.h"
#include "geometry/mass_properties.h"
#include "geometry/mesh_files.h"

#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// A rotation about one axis, in the model's axes.
struct RigidHinge {
  std::string name;
  Vec3 axis = Vec3::UnitX();
  double min = 0.0, max = 0.0;  ///< [rad], from the bind pose
};

/// A body of a RigidModel. Its frame has the model's axes in the bind pose and the joint as its origin.
struct RigidBody {
  std::string name;
  int parent = -1;                  ///< earlier in the list; -1: it moves freely
  Vec3 origin = Vec3::Zero();       ///< in model space, bind pose [m]
  std::vector<RigidHinge> hinges;   ///< between it and its parent, the outermost first; none: fixed to it
  std::vector<NamedMesh> hulls;     ///< in the body's frame; names are unique in the model
  double mass = 0.0;                ///< [kg]
  Vec3 center = Vec3::Zero();       ///< of mass, in the body's frame [m]
  Mat3 inertia = Mat3::Identity();  ///< about the centre of mass, along the body's axes [kg m^2]
  std::optional<JointIndex> joint;  ///< of the character
};

/// Bodies of a character or a mesh, for robotics engines: metres, kilograms, Y up as in Lorica.
struct RigidModel {
  std::string name;
  std::vector<RigidBody> bodies;  ///< parents precede children
  std::vector<std::pair<int, int>>
      overlapping;                 ///< bodies whose hulls overlap in the bind pose, besides parent and child
  std::vector<std::string> notes;  ///< what was changed or assumed: one sentence each
};

inline constexpr double kDensity = 1000.0;  ///< of the body, that of water [kg/m^3]

/// A body for each bone with a collider. Mass is the volume of the character's body times kDensity, divided among the
/// bodies by the volume of their hulls. Joints of human bones have the ranges of motion of skinning/humanoid, as up to
/// three hinges; other joints three hinges of 30 degrees to each side.
[[nodiscard]] RigidModel rigidModelOf(const Character& character, std::span<const RigidCollider> colliders);

/// One free body with a mesh's parts. Mass and inertia are those of the mesh's inside.
/// @param mesh  closed, its coordinates taken as metres
[[nodiscard]] RigidModel rigidModelOf(const std::string& name, const TriMesh& mesh, std::vector<NamedMesh> hulls);

/// Z-up coordinates of robotics, X forward and Y to the left, of Lorica's: Y up, Z forward, X to the left.
[[nodiscard]] inline Vec3 zUp(const Vec3& p) {
  return {p.z(), p.x(), p.y()};
}
[[nodiscard]] Mat3 zUp(const Mat3& inertia);

}  // namespace lorica
