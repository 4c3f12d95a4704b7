#include "capture/tracking/people_places.h"

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

}  // namespace lorica
