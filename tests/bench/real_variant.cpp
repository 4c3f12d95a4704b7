#include "tests/bench/real_variant.h"

#include "capture/smoothing.h"
#include "tests/bench/generators/swaying_camera.h"

#include <algorithm>
#include <utility>

namespace lorica::bench {
namespace {

class AlteredSource : public DepthSource {
 public:
  AlteredSource(std::unique_ptr<DepthSource> source, const RealVariant& variant)
      : source_(std::move(source)), variant_(variant) {}

  [[nodiscard]] const DepthCamera& camera() const override { return source_->camera(); }
  [[nodiscard]] std::string name() const override { return source_->name(); }
  [[nodiscard]] Result<DepthRead> next(DepthFrame& frame) override {
    for (; skipped_ < variant_.start; ++skipped_) {
      const Result<DepthRead> read = source_->next(frame);
      if (!read || *read != DepthRead::kFrame) return read;
    }
    const Result<DepthRead> read = source_->next(frame);
    if (!read || *read != DepthRead::kFrame) return read;
    if (variant_.sways) sway(camera(), frame_++, frame);
    if (!variant_.mirror) return read;
    for (auto row = frame.depthMm.begin(); row != frame.depthMm.end(); row += camera().width) {
      std::reverse(row, row + camera().width);
    }
    return read;
  }

 private:
  std::unique_ptr<DepthSource> source_;
  RealVariant variant_;
  int skipped_ = 0, frame_ = 0;
};

/// The joint of the other side.
BodyJoint mirrored(BodyJoint joint) {
  for (const BodyJoint left : kLeftJoints) {
    if (joint == left || joint == rightOf(left)) return joint == left ? rightOf(left) : left;
  }
  return joint;
}

}  // namespace

Joints altered(const Joints& joints, const RealVariant& variant) {
  if (!variant.mirror) return joints;
  SkeletonFrame frame;
  for (std::size_t j = 0; j < kBodyJointCount; ++j) frame.joints[j].position = joints[j];
  mirror(frame);
  return positionsOf(frame);
}

RealRecording altered(const RealRecording& recording, const RealVariant& variant) {
  RealRecording result = recording;
  result.firstFrame = std::max(0, recording.firstFrame - variant.start);
  for (std::map<int, Joints>& person : result.people) {
    std::map<int, Joints> shown;
    for (const auto& [frame, joints] : person) {
      if (frame < variant.start) continue;
      Joints now = joints;
      for (Vec3& joint : now) joint = variant.sways ? Vec3(swayAt(frame - variant.start) * joint) : joint;
      shown[frame - variant.start] = altered(now, variant);
    }
    person = std::move(shown);
  }
  result.marks.clear();
  for (const auto& [frame, people] : recording.marks) {
    if (frame < variant.start || variant.sways) continue;
    auto& shown = result.marks[frame - variant.start] = people;
    if (!variant.mirror) continue;
    for (std::vector<MarkedJoint>& marks : shown) {
      for (MarkedJoint& mark : marks) {
        mark.fromMiddle.x() *= -1.0;
        mark.joint = mirrored(mark.joint);
      }
    }
  }
  if (variant.mirror) {
    const Eigen::DiagonalMatrix<double, 3> flip(-1.0, 1.0, 1.0);
    result.floorFromCamera.linear() = flip * recording.floorFromCamera.linear() * flip;
  }
  return result;
}

std::unique_ptr<DepthSource> altered(std::unique_ptr<DepthSource> source, const RealVariant& variant) {
  return std::make_unique<AlteredSource>(std::move(source), variant);
}

}  // namespace lorica::bench
