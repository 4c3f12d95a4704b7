#pragma once

#include "skinning/character.h"

#include <functional>
#include <string>
#include <vector>

namespace lorica::test {

/// A joint at a given position below a parent; all rest rotations are identities.
struct Peg {
  std::string name;
  JointIndex parent = kNoJoint;
  Vec3 at = Vec3::Zero();  ///< [m], model space
};

/// A character without a mesh.
[[nodiscard]] Character bonesAt(const std::vector<Peg>& pegs);

/// Adds a mesh that only one joint moves.
void add(Character& character, const TriMesh& mesh, JointIndex joint);

/// Sets the members that depend on the mesh.
[[nodiscard]] Character finished(Character character);

/// The same triangles, each with its own three vertices.
[[nodiscard]] Character unindexed(const Character& character);

/// Without some triangles; vertices are kept.
[[nodiscard]] Character without(const Character& character, const std::function<bool(const Triangle&)>& dropped);

/// The mannequin with holes: about one triangle in `oneIn` is missing.
[[nodiscard]] Character tornMannequin(int oneIn);

/// The mannequin in open shells: without the triangles that two bones of its neck, shoulders, wrists and hips share.
[[nodiscard]] Character openMannequin();

/// The same with every other shell inside out.
[[nodiscard]] Character openMannequinInsideOut();

/// Adds a cape of 0.6 x 0.9 m that hangs from the shoulders, 15 cm behind the back, curved around it. One layer.
void addCape(Character& mannequin);

}  // namespace lorica::test
