#include "capture/tracking/people/plane_fit.h"

#include <algorithm>
#include <cmath>

namespace lorica {

std::size_t planeSampleCount(const DepthGrid& grid) {
  return grid.cellCount() / 16 + 1;
}

bool PlaneArms::seen() const {
  return left.z() != 0.0F && right.z() != 0.0F && above.z() != 0.0F && below.z() != 0.0F;
}

void PlaneMoments::add(const Vec3& position, double weight) {
  ++count_;
  weights_ += weight;
  sum_ += weight * position;
  products_ += weight * position * position.transpose();
}

PlaneMoments::Fit PlaneMoments::fit() const {
  const Vec3 middle = sum_ / weights_;
  const SymmetricAxes axes = symmetricAxes(Mat3(products_ / weights_ - middle * middle.transpose()));
  return {middle, axes.vectors.col(0), std::sqrt(std::max(0.0, axes.values[1]))};
}

}  // namespace lorica
