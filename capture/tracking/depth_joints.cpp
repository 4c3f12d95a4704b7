#include "capture/tracking/depth_joints.h"

#include "geometry/clock.h"
#include "geometry/counts.h"

namespace lorica {
namespace {

/// How long to wait for a live source before unknown joints are returned [s]; see DepthSource::next().
constexpr double kSilence = 0.1;
/// Time step after a clock has restarted [s].
constexpr double kFrameSeconds = 1.0 / 30.0;

Vec3 positionOf(const TrackedPerson& person) {
  return person.skeleton[BodyJoint::kTorso].position;
}

}  // namespace

DepthJoints::DepthJoints(std::unique_ptr<DepthSource> depth, Tracker tracker, int person)
    : depth_(std::move(depth)), tracker_(std::move(tracker)), wanted_(person) {}

DepthJoints::DepthJoints(std::unique_ptr<DepthSource> depth, Tracker tracker, PeoplePlaces places)
    : depth_(std::move(depth)), tracker_(std::move(tracker)), wanted_(0), places_(std::move(places)) {}

const TrackedPerson* DepthJoints::choose(std::span<const TrackedPerson> people) const {
  const int kept = wanted_ > 0 ? wanted_ : following_;
  const TrackedPerson* nearest = nullptr;
  for (const TrackedPerson& person : people) {
    if (person.skeleton.user == kept) return &person;
    if (nearest == nullptr || positionOf(person).squaredNorm() < positionOf(*nearest).squaredNorm()) nearest = &person;
  }
  return wanted_ > 0 ? nullptr : nearest;
}

double DepthJoints::riseTo(double sensorTime) {
  if (time_ && sensorTime + worldFromSensorTime_ <= *time_) {
    worldFromSensorTime_ = *time_ + kFrameSeconds - sensorTime;
  }
  return sensorTime + worldFromSensorTime_;
}

Result<std::optional<SkeletonFrame>> DepthJoints::next() {
  LORICA_TRY(const DepthRead read, depth_->next(sight_.image));
  sight_.read = read;
  sight_.people = 0;
  sight_.followed = false;
  sight_.roomUncertain = false;
  sight_.trackSeconds = 0.0;
  sight_.worn.reset();
  sight_.arrived = std::chrono::steady_clock::now();
  SkeletonFrame& joints = sight_.joints;
  joints = {};
  if (read == DepthRead::kEnd) return std::optional<SkeletonFrame>();
  if (read != DepthRead::kFrame) {
    time_ = time_ ? *time_ + kSilence : 0.0;
    joints.time = *time_;
    if (places_) fillPlaces({});
    return std::optional(joints);
  }

  sight_.worn = headset_ ? headset_->inImage(secondsOf(sight_.arrived)) : std::nullopt;
  const std::span<const TrackedPerson> people = tracker_.track(sight_.image, sight_.worn);
  sight_.trackSeconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - sight_.arrived).count();
  sight_.people = countOf(people);
  sight_.roomUncertain = tracker_.roomUncertain();
  sight_.floorFound = tracker_.floorFound();
  time_ = riseTo(sight_.image.time);
  follow(people);
  sight_.stage = stage_.value_or(Vec3::Zero());
  sight_.cameraFromWorld = tracker_.floorFromCamera().inverse() * Eigen::Translation3d(sight_.stage);
  return std::optional(joints);
}

/// Sets the joints of this frame.
void DepthJoints::follow(std::span<const TrackedPerson> people) {
  SkeletonFrame& joints = sight_.joints;
  const TrackedPerson* person = choose(people);
  if (person != nullptr) {
    sight_.followed = true;
    following_ = person->skeleton.user;
    if (!stage_) stage_ = Vec3(positionOf(*person).x(), 0.0, positionOf(*person).z());
    joints = person->skeleton;
    for (TrackedJoint& joint : joints.joints) joint.position -= *stage_;
  }
  joints.time = *time_;
  if (places_) fillPlaces(people);
}

/// Sets the joints of all places, and those of the first as this frame's.
void DepthJoints::fillPlaces(std::span<const TrackedPerson> people) {
  places_->update(people, *time_);
  sight_.places.assign(places_->frames().begin(), places_->frames().end());
  for (SkeletonFrame& frame : sight_.places) {
    for (TrackedJoint& joint : frame.joints) {
      if (joint.confidence > 0.0) joint.position -= stage_.value_or(Vec3::Zero());
    }
  }
  sight_.joints = sight_.places.front();
}

}  // namespace lorica
