#include "capture/tracking/people_places.h"

#include <algorithm>

namespace lorica {

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

}  // namespace lorica
