#include "capture/tracking/depth_joints.h"

#include "geometry/clock.h"
#include "geometry/counts.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

/// How far a torso may be from below its head, and a seen head from where its headset says that it is [m].
constexpr double kTorsoReach = 0.6, kHeadReach = 0.35;
constexpr double kLowest = 0.3;  ///< of a head: below it the person lies, and moves as a whole [m]

bool wears(const WornHead& worn, const SkeletonFrame& person) {
  const TrackedJoint& head = person[BodyJoint::kHead];
  if (head.confidence >= 0.5) return (head.position - worn.position).norm() < kHeadReach;
  const TrackedJoint& torso = person[BodyJoint::kTorso];
  const Vec3 off = torso.position - worn.position;
  return torso.confidence > 0.0 && std::hypot(off.x(), off.z()) < kTorsoReach;
}

/// How long to wait for a live source before unknown joints are returned [s]; see DepthSource::next().
constexpr double kSilence = 0.1;
/// Time step after a clock has restarted [s].
constexpr double kFrameSeconds = 1.0 / 30.0;

Vec3 positionOf(const TrackedPerson& person) {
  return person.skeleton[BodyJoint::kTorso].position;
}

}  // namespace

PeoplePlaces::PeoplePlaces(int count) : places_(std::max(count, 1)), frames_(places_.size()) {}

void PeoplePlaces::update(std::span<const TrackedPerson> people, double time) {
  for (Place& place : places_) {
    const auto is = [&](const TrackedPerson& person) { return person.skeleton.user == place.user; };
    if (std::none_of(people.begin(), people.end(), is)) place.user = 0;
  }
  for (const TrackedPerson& person : people) {
    const auto holds = [&](const Place& place) { return place.user == person.skeleton.user; };
    auto place = std::find_if(places_.begin(), places_.end(), holds);
    Place* taken = place != places_.end() ? &*place : placeFor(person, time);
    if (taken == nullptr) continue;
    *taken = {person.skeleton.user, time, person.skeleton[BodyJoint::kTorso].position};
    SkeletonFrame& frame = frames_[taken - places_.data()];
    frame = person.skeleton;
  }
  for (std::size_t p = 0; p < places_.size(); ++p) {
    const Place& place = places_[p];
    if (place.user == 0) frames_[p] = SkeletonFrame();
    const bool there = place.seen && time - *place.seen < kLostSeconds;
    frames_[p].user = there ? static_cast<int>(p) + 1 : kNobody;
    frames_[p].time = time;
  }
}

/// The kept place that was left nearest to a newcomer, else the first free one; null if there is none.
PeoplePlaces::Place* PeoplePlaces::placeFor(const TrackedPerson& newcomer, double time) {
  const Vec3& torso = newcomer.skeleton[BodyJoint::kTorso].position;
  Place* kept = nullptr;
  Place* free = nullptr;
  for (Place& place : places_) {
    if (place.user != 0) continue;
    if (!place.seen || time - *place.seen > kKeptSeconds) {
      if (free == nullptr) free = &place;
    } else if (kept == nullptr || (place.torso - torso).squaredNorm() < (kept->torso - torso).squaredNorm()) {
      kept = &place;
    }
  }
  return kept != nullptr ? kept : free;
}

void moveWithHead(const WornHead& then, const WornHead& latest, SkeletonFrame& person) {
  if (!wears(then, person)) return;
  const Vec3 moved = latest.position - then.position;
  for (TrackedJoint& joint : person.joints) {
    joint.position += std::clamp(joint.position.y() / std::max(then.position.y(), kLowest), 0.0, 1.0) * moved;
  }
  person[BodyJoint::kHead] = {latest.position, latest.orientation, 1.0};
}

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

LiveJoints::LiveJoints(DepthJoints joints)
    : joints_(std::move(joints)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

void LiveJoints::run(const std::stop_token& stop) {
  while (true) {
    Result<std::optional<SkeletonFrame>> got = joints_.next();
    const bool last = !got || !got->has_value();
    {
      const std::lock_guard lock(mutex_);
      if (stop.stop_requested()) return;
      latest_ = std::move(got);
      latestSight_ = joints_.sight();
      if (latestSight_.read == DepthRead::kFrame) ++latestFrameCount_;
      if (latestSight_.followed) ++latestFollowedCount_;
    }
    changed_.notify_one();
    if (last) return;
  }
}

Result<std::optional<SkeletonFrame>> LiveJoints::next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return latest_.has_value(); });
  Result<std::optional<SkeletonFrame>> given = *latest_;
  // The end and errors stay: later calls return them again.
  if (given && given->has_value()) {
    latest_.reset();
    std::swap(sight_, latestSight_);  // the other's storage is reused for the next image
  }
  ended_ = !given || !given->has_value();
  frameCount_ = latestFrameCount_;
  followedCount_ = latestFollowedCount_;
  return given;
}

namespace {

class PlaceJoints final : public SkeletonSource {
 public:
  PlaceJoints(const LiveJoints& joints, std::size_t place) : joints_(joints), place_(place) {}

  Result<std::optional<SkeletonFrame>> next() override {
    const std::vector<SkeletonFrame>& places = joints_.sight().places;
    if (joints_.ended() || place_ >= places.size()) return std::optional<SkeletonFrame>();
    return std::optional(places[place_]);
  }

 private:
  const LiveJoints& joints_;
  std::size_t place_;
};

}  // namespace

std::unique_ptr<SkeletonSource> makePlaceSource(const LiveJoints& joints, std::size_t place) {
  return std::make_unique<PlaceJoints>(joints, place);
}

bool LiveJoints::ready() const {
  const std::lock_guard lock(mutex_);
  return latest_.has_value();
}

}  // namespace lorica
