#include "tests/skinning/body/hard_characters.h"

#include "geometry/random_numbers.h"
#include "skinning/body/limbs.h"
#include "skinning/mannequin/mannequin.h"

#include <algorithm>
#include <cmath>

namespace lorica::test {
namespace {

JointIndex strongestOf(const Character& character, VertexIndex v) {
  const auto i = static_cast<std::size_t>(v);
  return strongest(
      std::span(character.influences)
          .subspan(character.influenceBegin[i], character.influenceBegin[i + 1] - character.influenceBegin[i]));
}

}  // namespace

Character bonesAt(const std::vector<Peg>& pegs) {
  Character character;
  std::vector<Joint> joints;
  for (const Peg& peg : pegs) {
    Joint joint;
    joint.name = peg.name;
    joint.parent = peg.parent;
    const Vec3 from = peg.parent == kNoJoint ? Vec3::Zero() : pegs[peg.parent].at;
    joint.rest.translation = peg.at - from;
    joints.push_back(joint);
    Affine3 jointFromModel = Affine3::Identity();
    jointFromModel.translation() = -peg.at;
    character.jointFromModel.push_back(jointFromModel);
  }
  character.skeleton = Skeleton::create(joints).value();
  character.influenceBegin = {0};
  return character;
}

void add(Character& character, const TriMesh& mesh, JointIndex joint) {
  const auto offset = static_cast<VertexIndex>(character.mesh.vertices.size());
  for (const Vec3& v : mesh.vertices) {
    character.mesh.vertices.push_back(v);
    character.influences.push_back({joint, 1.0});
    character.influenceBegin.push_back(static_cast<std::uint32_t>(character.influences.size()));
  }
  for (const Triangle& t : mesh.triangles) {
    character.mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  }
}

Character finished(Character character) {
  const Aabb box = boundsOf(character.mesh.vertices);
  character.height = box.empty() ? 0.0 : box.max.y() - box.min.y();
  return character;
}

Character unindexed(const Character& character) {
  Character loose = character;
  loose.mesh = {};
  loose.influences.clear();
  loose.influenceBegin = {0};
  for (const Triangle& t : character.mesh.triangles) {
    const auto first = static_cast<VertexIndex>(loose.mesh.vertices.size());
    for (const VertexIndex v : t) {
      const auto i = static_cast<std::size_t>(v);
      loose.mesh.vertices.push_back(character.mesh.vertices[i]);
      loose.influences.insert(loose.influences.end(), character.influences.begin() + character.influenceBegin[i],
                              character.influences.begin() + character.influenceBegin[i + 1]);
      loose.influenceBegin.push_back(static_cast<std::uint32_t>(loose.influences.size()));
    }
    loose.mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return loose;
}

Character without(const Character& character, const std::function<bool(const Triangle&)>& dropped) {
  Character rest = character;
  std::erase_if(rest.mesh.triangles, dropped);
  return rest;
}

Character tornMannequin(int oneIn) {
  RandomNumbers random(17);
  return without(makeMannequin(),
                 [&](const Triangle&) { return random.bits() % static_cast<std::uint64_t>(oneIn) == 0; });
}

Character openMannequin() {
  const Character whole = makeMannequin();
  std::vector<JointIndex> cuts;
  for (const HumanBone bone :
       {HumanBone::kHead, HumanBone::kLeftUpperArm, HumanBone::kRightUpperArm, HumanBone::kLeftHand,
        HumanBone::kRightHand, HumanBone::kLeftUpperLeg, HumanBone::kRightUpperLeg, HumanBone::kRightFoot}) {
    cuts.push_back(whole.skeleton.jointOf(bone));
  }
  return without(whole, [&](const Triangle& t) {
    for (const JointIndex cut : cuts) {
      int of = 0;
      for (const VertexIndex v : t) of += strongestOf(whole, v) == cut ? 1 : 0;
      const JointIndex parent = whole.skeleton.joint(cut).parent;
      int ofParent = 0;
      for (const VertexIndex v : t) ofParent += strongestOf(whole, v) == parent ? 1 : 0;
      if (of > 0 && ofParent > 0) return true;
    }
    return false;
  });
}

Character openMannequinInsideOut() {
  Character character = openMannequin();
  const Components shells = connectedComponents(character.mesh.vertices.size(), character.mesh.triangles);
  for (std::size_t k = 0; k < character.mesh.triangles.size(); ++k) {
    Triangle& t = character.mesh.triangles[k];
    if (shells.componentOfTriangle[k] % 2 == 1) std::swap(t[1], t[2]);
  }
  return character;
}

void addCape(Character& mannequin) {
  constexpr int kAcross = 12;
  constexpr int kDown = 18;
  TriMesh cape;
  for (int row = 0; row <= kDown; ++row) {
    for (int column = 0; column <= kAcross; ++column) {
      const double across = static_cast<double>(column) / kAcross - 0.5;
      cape.vertices.emplace_back(0.6 * across, 1.4 - 0.9 * row / kDown, -0.3 + 0.4 * across * across);
    }
  }
  for (int row = 0; row < kDown; ++row) {
    for (int column = 0; column < kAcross; ++column) {
      const VertexIndex a = row * (kAcross + 1) + column;
      const VertexIndex below = a + kAcross + 1;
      cape.triangles.push_back({a, a + 1, below});
      cape.triangles.push_back({a + 1, below + 1, below});
    }
  }
  add(mannequin, cape, mannequin.skeleton.jointOf(HumanBone::kChest));
}

}  // namespace lorica::test
