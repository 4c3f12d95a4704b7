#include "capture/headset/three_point_joints.h"

#include "capture/headset/three_point_body.h"

#include "geometry/clock.h"

#include <algorithm>
#include <utility>

namespace lorica {
namespace {

constexpr double kStep = 1e-3;  // between frames that show the same [s]

class ThreePointJoints final : public SkeletonSource {
 public:
  explicit ThreePointJoints(std::shared_ptr<const WornHeadset> headset) : headset_(std::move(headset)) {
    frame_.user = kNobody;
  }

  Result<std::optional<SkeletonFrame>> next() override {
    const std::optional<HeadAndHands> newest = headset_->newest();
    if (newest && (frame_.user == kNobody || newest->time > frame_.time)) {
      frame_ = body_.follow(*newest);
    } else {
      frame_.time = std::max(frame_.time + kStep, now());
    }
    return std::optional(frame_);
  }

 private:
  std::shared_ptr<const WornHeadset> headset_;
  ThreePointBody body_;
  SkeletonFrame frame_;
};

}  // namespace

std::unique_ptr<SkeletonSource> makeThreePointJoints(std::shared_ptr<const WornHeadset> headset) {
  return std::make_unique<ThreePointJoints>(std::move(headset));
}

}  // namespace lorica
