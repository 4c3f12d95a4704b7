#pragma once

#include "skinning/skeleton.h"
#include "tests/bench/generators/subdivision.h"

#include <utility>
#include <vector>

namespace lorica {

/// The bone weights of a point of the cage; they sum to 1.
using BoneWeights = std::vector<std::pair<HumanBone, double>>;

/// The left half (x >= 0) of the mannequin's control cage: points that its surface passes through, their bone weights,
/// and faces counter-clockwise from outside. Points with x == 0 are in the plane of symmetry. Frame: model [m].
///
/// A limb is a tube of rings. A ring lists its points right-handed about the direction in which the tube extends, so
/// that faces which bridge it to the next ring face outward.
class HalfCage {
 public:
  using Ring = std::vector<int>;

  int addPoint(const Vec3& p, BoneWeights weights);
  void addFace(std::vector<int> corners) { faces_.push_back(std::move(corners)); }
  /// Adds quads between two rings of equal size; `skipped` is a side of the tube to leave out, or -1.
  void bridge(const Ring& from, const Ring& to, int skipped = -1);

  [[nodiscard]] const std::vector<Vec3>& points() const { return points_; }
  [[nodiscard]] const std::vector<BoneWeights>& weights() const { return weights_; }
  [[nodiscard]] const PolygonFaces& faces() const { return faces_; }

 private:
  std::vector<Vec3> points_;
  std::vector<BoneWeights> weights_;
  PolygonFaces faces_;
};

/// The rings where the limbs join the trunk. Ten points each.
struct TrunkOpenings {
  HalfCage::Ring arm;  ///< right-handed about +X, from the top
  HalfCage::Ring leg;  ///< right-handed about -Y, from the middle of the back
};

[[nodiscard]] TrunkOpenings addTrunkAndHead(HalfCage& cage);
void addArmAndHand(HalfCage& cage, const HalfCage::Ring& opening);
void addLegAndFoot(HalfCage& cage, const HalfCage::Ring& opening);

}  // namespace lorica
