#include "tests/bench/generators/mannequin_cage.h"

#include "geometry/counts.h"
#include "geometry/result.h"

namespace lorica {

int HalfCage::addPoint(const Vec3& p, BoneWeights weights) {
  points_.push_back(p);
  weights_.push_back(std::move(weights));
  return countOf(points_) - 1;
}

void HalfCage::bridge(const Ring& from, const Ring& to, int skipped) {
  LORICA_CHECK(from.size() == to.size(), "rings of a tube have equal size");
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (static_cast<int>(i) == skipped) continue;
    const std::size_t j = (i + 1) % from.size();
    addFace({from[i], from[j], to[j], to[i]});
  }
}

}  // namespace lorica
