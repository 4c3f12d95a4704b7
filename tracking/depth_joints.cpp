#include "tracking/depth_joints.h"

#include <utility>

namespace lorica {
namespace {

/// How long a live source is waited for before unknown joints are given [s]; see DepthSource::next().
constexpr double kSilence = 0.1;
/// What a clock that started anew is moved on by [s].
constexpr double kFrameSeconds = 1.0 / 30.0;

Vec3 placeOf(const TrackedPerson& person) {
  return person.skeleton[BodyJoint::kTorso].position;
}

}  // namespace

DepthJoints::DepthJoints(std::unique_ptr<DepthSource> depth, Tracker tracker, int person)
    : depth_(std::move(depth)), tracker_(std::move(tracker)), wanted_(person) {}

const TrackedPerson* DepthJoints::choose(std::span<const TrackedPerson> people) const {
  const int kept = wanted_ > 0 ? wanted_ : following_;
  const TrackedPerson* nearest = nullptr;
  for (const TrackedPerson& person : people) {
    if (person.skeleton.user == kept) return &person;
    if (nearest == nullptr || placeOf(person).squaredNorm() < placeOf(*nearest).squaredNorm()) nearest = &person;
  }
  return wanted_ > 0 ? nullptr : nearest;
}

double DepthJoints::riseTo(double sensorTime) {
  if (time_ && sensorTime + worldFromSensorTime_ <= *time_) {
    worldFromSensorTime_ = *time_ + kFrameSeconds - sensorTime;
  }
  return sensorTime + worldFromSensorTime_;
}

Isometry3 DepthJoints::cameraFromWorld() const {
  return tracker_.floorFromCamera().inverse() * Eigen::Translation3d(stage_.value_or(Vec3::Zero()));
}

Result<std::optional<SkeletonFrame>> DepthJoints::next() {
  const Result<DepthRead> read = depth_->next(image_);
  if (!read) return read.error();
  sight_ = {};
  sight_.read = *read;
  sight_.arrived = std::chrono::steady_clock::now();
  if (*read == DepthRead::kEnd) return std::optional<SkeletonFrame>();

  joints_ = {};
  if (*read != DepthRead::kFrame) {
    time_ = time_ ? *time_ + kSilence : 0.0;
    joints_.time = *time_;
    return std::optional(joints_);
  }

  const std::span<const TrackedPerson> people = tracker_.track(image_);
  sight_.trackSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - sight_.arrived).count();
  sight_.people = static_cast<int>(people.size());
  time_ = riseTo(image_.time);
  if (const TrackedPerson* person = choose(people)) {
    sight_.followed = true;
    following_ = person->skeleton.user;
    if (!stage_) stage_ = Vec3(placeOf(*person).x(), 0.0, placeOf(*person).z());
    joints_ = person->skeleton;
    for (TrackedJoint& joint : joints_.joints) joint.position -= *stage_;
  }
  joints_.time = *time_;
  return std::optional(joints_);
}

}  // namespace lorica
