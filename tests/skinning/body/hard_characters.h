#pragma once

#include "skinning/character.h"

#include <functional>
#include <string>
#include <vector>

namespace lorica::test {

/// A skeleton of joints at given places, each hanging on another; all rest without rotation.
struct Peg {
  std::string name;
  JointIndex parent = kNoJoint;
  Vec3 at = Vec3::Zero();  ///< [m], model space
};

/// A character without a mesh.
[[nodiscard]] Character bonesAt(const std::vector<Peg>& pegs);

/// Adds a mesh that one joint moves alone.
void add(Character& character, const TriMesh& mesh, JointIndex joint);

/// Sets what follows from the mesh.
[[nodiscard]] Character finished(Character character);

/// The same triangles, each with three vertices of its own.
[[nodiscard]] Character unindexed(const Character& character);

/// Without some triangles; vertices stay.
[[nodiscard]] Character without(const Character& character, const std::function<bool(const Triangle&)>& dropped);

/// The mannequin with holes: about one triangle in `oneIn` is missing.
[[nodiscard]] Character tornMannequin(int oneIn);

/// The mannequin in open shells: without the triangles that two bones of its neck, shoulders, wrists and hips share.
[[nodiscard]] Character openMannequin();

/// The same with every other shell inside out.
[[nodiscard]] Character openMannequinInsideOut();

/// A cape of 0.6 x 0.9 m that hangs down from the shoulders, 15 cm behind the back, curved round it. One layer.
void addCape(Character& mannequin);

}  // namespace lorica::test
