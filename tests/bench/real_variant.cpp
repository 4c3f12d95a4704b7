#include "tests/bench/real_variant.h"

#include "capture/smoothing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace lorica::bench {
namespace {

/// Camera that sways from camera that stands, in a frame counted from the first one shown.
Mat3 swayAt(int frame) {
  const double seconds = frame / 30.0, degree = M_PI / 180.0;
  return (Eigen::AngleAxisd(6.0 * degree * std::sin(2.0 * M_PI * seconds / 4.0), Vec3::UnitZ()) *
          Eigen::AngleAxisd(7.0 * degree * std::sin(2.0 * M_PI * seconds / 6.0), Vec3::UnitY()))
      .toRotationMatrix();
}

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
    if (variant_.sways) sway(frame);
    if (!variant_.mirror) return read;
    for (auto row = frame.depthMm.begin(); row != frame.depthMm.end(); row += camera().width) {
      std::reverse(row, row + camera().width);
    }
    return read;
  }

 private:
  /// Turning does not uncover anything: each pixel shows what was seen in its direction.
  void sway(DepthFrame& frame) {
    const DepthCamera& c = camera();
    const Mat3 swaying = swayAt(frame_++);
    still_ = frame.depthMm;
    for (int row = 0; row < c.height; ++row) {
      for (int column = 0; column < c.width; ++column) {
        const Vec3 ray((column + 0.5 - 0.5 * c.width) / c.focalX(), (0.5 * c.height - row - 0.5) / c.focalY(), -1.0);
        const Vec3 before = swaying.transpose() * ray;
        const int u = static_cast<int>(std::floor(0.5 * c.width - c.focalX() * before.x() / before.z()));
        const int v = static_cast<int>(std::floor(0.5 * c.height + c.focalY() * before.y() / before.z()));
        const bool inside = u >= 0 && u < c.width && v >= 0 && v < c.height;
        const double depth = inside ? still_[static_cast<std::size_t>(v) * c.width + u] : 0.0;
        frame.depthMm[static_cast<std::size_t>(row) * c.width + column] =
            static_cast<std::uint16_t>(std::lround(depth / -before.z()));
      }
    }
  }

  std::unique_ptr<DepthSource> source_;
  RealVariant variant_;
  std::vector<std::uint16_t> still_;
  int skipped_ = 0, frame_ = 0;
};

/// The joint of the other side.
BodyJoint mirrored(BodyJoint joint) {
  SkeletonFrame frame;
  frame[joint].confidence = 1.0;
  mirror(frame);
  const auto at = std::ranges::find(frame.joints, 1.0, &TrackedJoint::confidence);
  return static_cast<BodyJoint>(at - frame.joints.begin());
}

}  // namespace

Joints altered(const Joints& joints, const RealVariant& variant) {
  if (!variant.mirror) return joints;
  SkeletonFrame frame;
  for (std::size_t j = 0; j < kBodyJointCount; ++j) frame.joints[j].position = joints[j];
  mirror(frame);
  Joints result;
  for (std::size_t j = 0; j < kBodyJointCount; ++j) result[j] = frame.joints[j].position;
  return result;
}

RealRecording altered(const RealRecording& recording, const RealVariant& variant) {
  RealRecording result = recording;
  result.firstFrame = std::max(0, recording.firstFrame - variant.start);
  for (std::map<int, Joints>& person : result.people) {
    std::map<int, Joints> shown;
    for (const auto& [frame, joints] : person) {
      if (frame < variant.start) continue;
      Joints& now = shown[frame - variant.start] = altered(joints, variant);
      for (Vec3& joint : now) joint = variant.sways ? Vec3(swayAt(frame - variant.start) * joint) : joint;
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
