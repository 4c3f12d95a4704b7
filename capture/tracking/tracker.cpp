#include "capture/tracking/tracker.h"

#include "capture/tracking/fit/person_fit.h"
#include "capture/tracking/people/people.h"
#include "geometry/errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace lorica {
namespace {

/// A person unseen for this long is no longer tracked [s].
constexpr double kForgetSeconds = 2.0;
/// Something still that the body has not explained for this long is furniture [s].
constexpr double kDoubtSeconds = 1.0;
/// Whoever is not believed yet and covers less than this share of what they covered is fitted anew.
constexpr double kShrunk = 0.75;
/// A person who covers less than one of so many pixels of the image shows no pose.
constexpr int kMinShare = 256;
/// How far the middle of somebody bowed is from below their head [m].
constexpr double kWearerReach = 0.6;
constexpr std::uint8_t kNotMeasured = 255;

/// The fit of one person; reused for later people to keep its memory.
struct Seat {
  int user = 0;  ///< 0 = free
  double firstTime = 0.0, lastTime = 0.0;
  bool seen = false, fitted = false;
  int mostPixels = 0;  ///< of somebody who is fitted but not believed
  fit::PersonFit fit;
  fit::BodyBelief belief;
};

/// The user number of the person under a headset; 0 = nobody.
int wearerOf(std::span<const PersonSegment> people, const WornHead& worn) {
  int wearer = 0;
  double nearest = kWearerReach;
  for (const PersonSegment& person : people) {
    const double away = std::hypot(person.middle.x() - worn.position.x(), person.middle.z() - worn.position.z());
    if (away >= nearest) continue;
    nearest = away;
    wearer = person.user;
  }
  return wearer;
}

fit::WornView viewOf(const WornHead& worn) {
  return {worn.position.cast<float>(), worn.ahead().cast<float>()};
}

}  // namespace

struct Tracker::Impl {
  Impl(const DepthCamera& device, const TrackerSettings& settings)
      : camera(device), finder(device, settings.maxPeople), view(device), seats(settings.maxPeople) {
    view.setLowerBody(settings.lowerBody);
    reported.reserve(seats.size());
    labels.resize(static_cast<std::size_t>(device.width) * device.height);
  }

  Seat* seatOf(const PersonSegment& person, double time) {
    for (Seat& seat : seats) {
      if (seat.user == person.user) return &seat;
    }
    if (person.pixelCount * kMinShare < camera.width * camera.height) return nullptr;
    for (Seat& seat : seats) {
      if (seat.user != 0) continue;
      seat.user = person.user;
      seat.firstTime = seat.lastTime = time;
      seat.fitted = false;
      seat.fit.forget();
      seat.belief.forget();
      return &seat;
    }
    return nullptr;
  }

  DepthCamera camera;
  PeopleFinder finder;
  fit::BodyView view;
  fit::PosedModel body;
  std::vector<Seat> seats;
  std::vector<TrackedPerson> reported;
  std::vector<std::uint8_t> labels;       ///< of those who are believed
  std::array<std::uint8_t, 256> shown{};  ///< label of the finder to label
  Isometry3 floorFromCamera = Isometry3::Identity();
  bool begun = false;
  bool roomUncertain = false;
};

Tracker::Tracker(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Tracker::~Tracker() = default;
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;

Result<Tracker> Tracker::create(const DepthCamera& camera, const TrackerSettings& settings) {
  if (settings.maxPeople < 1 || settings.maxPeople > 6) {
    return invalidArgument("the number of people to track is {}, expected 1 to 6", settings.maxPeople);
  }
  if (camera.width < 80 || camera.height < 60 || camera.width > 4096 || camera.height > 4096) {
    return invalidArgument("the depth camera's images are {} x {}, expected 80 x 60 to 4096 x 4096", camera.width,
                           camera.height);
  }
  const auto isAngle = [](double a) { return a > 0.1 && a < 2.8; };
  if (!isAngle(camera.horizontalFov) || !isAngle(camera.verticalFov)) {
    return invalidArgument("the depth camera's field of view is {} x {} rad, expected 0.1 to 2.8 each",
                           camera.horizontalFov, camera.verticalFov);
  }
  return Tracker(std::make_unique<Impl>(camera, settings));
}

std::span<const TrackedPerson> Tracker::track(const DepthFrame& frame, const std::optional<WornHead>& worn) {
  Impl& t = *impl_;
  t.reported.clear();
  const auto pixels = static_cast<std::size_t>(t.camera.width) * t.camera.height;
  if (frame.depthMm.size() != pixels) return {};
  t.finder.find(frame);
  const Isometry3& floor = t.finder.floorFromCamera();
  if (t.begun && !floor.isApprox(t.floorFromCamera, 1e-9)) {
    const Eigen::Isometry3f newFromOld((floor * t.floorFromCamera.inverse()).cast<float>());
    for (Seat& seat : t.seats) {
      if (seat.user != 0) seat.fit.move(newFromOld);
    }
  }
  t.begun = true;
  t.floorFromCamera = floor;

  for (Seat& seat : t.seats) {
    seat.seen = false;
    // Before anyone is processed: a newcomer may have the number of someone who left.
    if (seat.user != 0 && frame.time - seat.lastTime > kForgetSeconds) seat.user = 0;
  }
  const auto people = t.finder.people();
  const int wearer = worn ? wearerOf(people, *worn) : 0;
  t.roomUncertain = false;
  t.shown.fill(0);
  t.shown[kNotMeasured] = kNotMeasured;
  for (std::size_t i = 0; i < people.size(); ++i) {
    Seat* seat = t.seatOf(people[i], frame.time);
    if (!seat || people[i].pixelCount * kMinShare < t.camera.width * t.camera.height / 3) continue;
    t.view.look(frame.depthMm, t.finder.labels(), i + 1, floor, t.finder.floorFound());
    t.view.setAttached(people[i].attached);
    // Furniture was taken for a part of somebody who is not believed yet.
    if (!seat->belief.believed()) {
      const int covered = people[i].pixelCount;
      seat->mostPixels = seat->fitted ? std::max(seat->mostPixels, covered) : covered;
      if (covered < kShrunk * seat->mostPixels) {
        seat->fit.forget();
        seat->fitted = false;
      }
    }
    const bool wears = people[i].user == wearer;
    t.view.setWorn(wears ? std::optional(viewOf(*worn)) : std::nullopt);
    t.view.setWaistUp(seat->fit.isWaistUp(t.view));
    seat->seen = seat->fit.follow(t.view, frame.time - seat->lastTime);
    if (!seat->seen) continue;
    seat->fitted = true;
    seat->lastTime = frame.time;
    seat->belief.update({seat->fit.cost(), seat->fit.support(), seat->fit.height(), people[i].moved, people[i].attached,
                         t.view.lowerBody() || t.view.headOutside(), t.view.waistUp()});
    poseBody(seat->fit.pose(), seat->fit.proportions(), t.body);
    t.finder.explain(seat->user, t.body);
    const bool doubtful = !seat->belief.believed() && frame.time - seat->firstTime > kDoubtSeconds;
    t.roomUncertain = t.roomUncertain || people[i].attached || (doubtful && people[i].moved);
    if (seat->belief.believed()) {
      t.finder.confirm(seat->user);
      t.shown[i + 1] = i + 1;
    } else if (doubtful && !people[i].moved) {
      t.finder.reject(seat->user);
      seat->user = 0;
    }
  }
  for (Seat& seat : t.seats) {
    if (seat.user == 0 || !seat.seen || !seat.belief.believed()) continue;
    TrackedPerson person;
    seat.fit.report(person.skeleton);
    person.skeleton.time = frame.time;
    person.skeleton.user = seat.user;
    person.height = seat.fit.height();
    person.residual = seat.fit.support().meanDistance;
    person.proportionsKnown = seat.fit.proportionsKnown();
    t.reported.push_back(person);
  }
  std::sort(t.reported.begin(), t.reported.end(),
            [](const TrackedPerson& a, const TrackedPerson& b) { return a.skeleton.user < b.skeleton.user; });
  return t.reported;
}

const Isometry3& Tracker::floorFromCamera() const {
  return impl_->floorFromCamera;
}
bool Tracker::floorFound() const {
  return impl_->finder.floorFound();
}
bool Tracker::roomUncertain() const {
  return impl_->roomUncertain;
}
std::span<const std::uint8_t> Tracker::labels() {
  const std::span<const std::uint8_t> found = impl_->finder.labels();
  for (std::size_t i = 0; i < found.size(); ++i) impl_->labels[i] = impl_->shown[found[i]];
  return impl_->labels;
}

}  // namespace lorica
