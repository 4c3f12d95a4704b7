#include "tests/session/meeting_run.h"

#include "capture/files/joint_csv.h"
#include "capture/tracking/depth_joints.h"
#include "capture/tracking/tracker.h"
#include "capture/virtual_sensor/virtual_performer.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "geometry/triangle_tree.h"
#include "session/session.h"
#include "session/treated_source.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/bench/generators/motion_clips.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

namespace lorica::test {
namespace {

using motion::FigurePose;
using motion::kLeft;
using motion::kRight;
using motion::minimumJerk;
using motion::Side;

constexpr double kSeconds = 4.0;
constexpr double kPi = std::numbers::pi;

/// One of the two: where they stand, and which way they face along X.
struct Actor {
  double x = 0.0, z = 0.0;  ///< on the floor [m]
  double yaw = 0.0;         ///< 0 faces the camera [rad]
  double walked = 0.0;      ///< distance so far: moves the feet [m]
};

/// 0, then 1 from `from` + `rise` until `to`, then 0 again `rise` later.
double during(double t, double from, double to, double rise) {
  return minimumJerk((t - from) / rise) * (1.0 - minimumJerk((t - to) / rise));
}

FigurePose standing(const Actor& actor) {
  FigurePose figure;
  const Quat turn = motion::turned(actor.yaw, 0.0, 0.0);
  const Vec3 ground(actor.x, 0.0, actor.z);
  figure.worldFromPelvis = figure.worldFromHead = turn;
  figure.pelvis = ground + Vec3(0.0, 0.905, 0.0);
  for (const Side side : {kLeft, kRight}) {
    const double mirror = side == kLeft ? 1.0 : -1.0;
    const double swing = mirror * std::sin(kPi * actor.walked / 0.45);
    const double lifted = mirror * std::cos(kPi * actor.walked / 0.45);
    figure.feet[side].ankle =
        ground + turn * Vec3(0.1 * mirror, motion::kAnkle, 0.12 * swing) +
        Vec3(0.0, actor.walked > 0.0 ? 0.04 * std::max(0.0, lifted * minimumJerk(actor.walked / 0.2)) : 0.0, 0.0);
    figure.feet[side].rotation = turn;
    figure.arms[side] = motion::reach(motion::kHang, motion::kHangPole);
  }
  return figure;
}

/// Moves a hand from hanging to a position. @param share  0 hangs, 1 is there  @param wrist  world [m]
void moveHand(FigurePose& figure, Side side, const Vec3& wrist, double share,
              const Vec3& pole = Vec3(0.35, -1.0, -0.2)) {
  const double mirror = side == kLeft ? 1.0 : -1.0;
  const Quat worldFromChest = figure.worldFromPelvis * figure.pelvisFromChest;
  const Vec3 shoulder =
      figure.pelvis + figure.worldFromPelvis * Vec3(0.0, motion::kHipsToTorso, 0.0) +
      worldFromChest * Vec3(mirror * motion::kShoulderHalfWidth, motion::kTorsoToNeck - motion::kShoulderDrop, 0.0);
  Vec3 hand = worldFromChest.conjugate() * (wrist - shoulder);
  hand.x() *= mirror;
  figure.arms[side] = motion::reach(motion::kHang + share * (hand - motion::kHang),
                                    motion::kHangPole + share * (pole - motion::kHangPole));
}

/// Both people at a time: the first at -x, facing +X, and the second at x.
using Choreography = std::function<FigurePose(double t, int person, double ahead)>;

/// @param act  gets the time [s], the person, and the person's direction along X: 1 or -1
Meeting performed(std::string name, const Choreography& act) {
  Meeting meeting{std::move(name), {}};
  for (int i = 0; i <= static_cast<int>(30.0 * kSeconds); ++i) {
    const double t = i / 30.0;
    meeting.people[0].push_back(motion::solve(act(t, 0, 1.0), t));
    meeting.people[1].push_back(motion::solve(act(t, 1, -1.0), t));
  }
  return meeting;
}

/// Right hands meet in the middle and go up and down.
FigurePose shakeHands(double t, int, double ahead) {
  FigurePose figure = standing({-0.38 * ahead, 0.0, 0.5 * kPi * ahead});
  const double up = 0.04 * during(t, 1.2, 2.6, 0.3) * std::sin(4.0 * kPi * t);
  moveHand(figure, kRight, Vec3(-0.08 * ahead, 1.05 + up, 0.015 * ahead), during(t, 0.7, 2.8, 0.6));
  return figure;
}

/// Both keep their guard; the first hits the other's chest with the right fist and then the left, the second in
/// between.
FigurePose box(double t, int person, double ahead) {
  FigurePose figure = standing({-0.33 * ahead, 0.0, 0.5 * kPi * ahead});
  const double guard = during(t, 0.4, 3.2, 0.5), shift = person == 0 ? 0.0 : 0.5;
  const double right = during(t, 1.1 + shift, 1.3 + shift, 0.15), left = during(t, 2.1 + shift, 2.3 + shift, 0.15);
  figure.pelvisFromChest = motion::turned(0.25 * (right - left), 0.05 * guard, 0.0);
  const double side = -ahead;  // of the left hand along Z
  const auto fist = [&](double hit, double aside) {
    const Vec3 kept(-0.05 * ahead, 1.38, 0.1 * aside), struck(0.15 * ahead, 1.25, 0.04 * aside);
    return Vec3(kept + hit * (struck - kept));
  };
  moveHand(figure, kRight, fist(right, -side), guard);
  moveHand(figure, kLeft, fist(left, side), guard);
  return figure;
}

/// They walk up to each other, put their arms around each other, the left one above, and walk back.
FigurePose hug(double t, int, double ahead) {
  const double near = during(t, 0.5, 2.6, 0.8), around = during(t, 1.0, 2.4, 0.5);
  const double x = 0.48 - 0.34 * near;
  FigurePose figure = standing({-x * ahead, 0.0, 0.5 * kPi * ahead, 0.34 * near});
  for (const Side side : {kLeft, kRight}) {
    const double aside = side == kLeft ? -ahead : ahead;
    const double in = minimumJerk((t - 1.4) / 0.4) * (1.0 - minimumJerk((t - 2.4) / 0.4));
    const Vec3 wrist((x + 0.12 * in) * ahead, side == kLeft ? 1.42 : 1.15, (0.32 - 0.22 * in) * aside);
    moveHand(figure, side, wrist, around, Vec3(1.0, -0.4, 0.0));
  }
  return figure;
}

/// They walk past each other, shoulders touching, the first before the second as seen from the camera, and turn around.
FigurePose changePlaces(double t, int, double ahead) {
  const double u = minimumJerk((t - 0.5) / 2.2), turn = minimumJerk((t - 2.7) / 0.9);
  Actor actor{-0.62 * (1.0 - 2.0 * u) * ahead, 0.21 * std::sin(kPi * u) * ahead, (0.5 + turn) * kPi * ahead};
  actor.walked = 1.24 * u * (1.0 - minimumJerk((t - 2.5) / 0.2));
  return standing(actor);
}

}  // namespace

std::vector<Meeting> meetings() {
  return {performed("shake_hands", shakeHands), performed("box", box), performed("hug", hug),
          performed("change_places", changePlaces)};
}

namespace {

constexpr double kTolerance = 0.02;  ///< [m]
using TwoOf = std::array<std::vector<SkeletonFrame>, 2>;

/// The two people, who differ in height and girth.
Result<std::array<VirtualPerformer, 2>> performersOf(const Meeting& meeting) {
  Result<VirtualPerformer> first = VirtualPerformer::create(makeMannequin(), meeting.people[0]);
  if (!first) return first.error();
  Result<VirtualPerformer> second =
      VirtualPerformer::create(withProportions(makeMannequin(), {.height = 1.04, .girth = 1.05}), meeting.people[1]);
  if (!second) return second.error();
  return std::array{std::move(*first), std::move(*second)};
}

Result<VirtualSensor> sensorBefore(const Meeting& meeting, const MeetingSettings& settings) {
  Result<std::array<VirtualPerformer, 2>> performers = performersOf(meeting);
  if (!performers) return performers.error();
  std::vector<VirtualPerson> people;
  for (VirtualPerformer& performer : *performers) people.push_back({std::move(performer)});
  VirtualSensorSettings sensor;
  sensor.camera = settings.camera;
  sensor.noise = settings.noise;
  sensor.framesPerSecond = settings.framesPerSecond;
  sensor.room.worldFromCamera = worldFromCameraAt({0.0, 1.1, 2.9}, 0.05);
  return VirtualSensor::create(std::move(people), sensor);
}

/// Sum of the distances of all joints that are known; none if none is.
std::optional<double> apart(const SkeletonFrame& a, const SkeletonFrame& b) {
  double sum = 0.0;
  int known = 0;
  for (int j = 0; j < kBodyJointCount; ++j) {
    const auto joint = static_cast<BodyJoint>(j);
    if (a[joint].confidence <= 0.0) continue;
    sum += (a[joint].position - b[joint].position).norm();
    ++known;
  }
  return known > 0 ? std::optional(sum / known) : std::nullopt;
}

/// Follows the people and judges who is who.
Result<TwoOf> follow(VirtualSensor& sensor, MeetingResult& result) {
  Result<Tracker> tracker = Tracker::create(sensor.camera());
  if (!tracker) return tracker.error();
  PeoplePlaces places(2);
  TwoOf followed;
  bool crossed = false;  // the second person came first
  int errors = 0;
  DepthFrame depth;
  while (true) {
    const Result<DepthRead> read = sensor.next(depth);
    if (!read) return read.error();
    if (*read != DepthRead::kFrame) break;
    places.update(tracker->track(depth), depth.time);
    std::array<std::optional<double>, 2> straight, exchanged;
    for (std::size_t p = 0; p < 2; ++p) {
      const SkeletonFrame& frame = places.frames()[p];
      followed[p].push_back(frame);
      const auto truth = [&](std::size_t person) {
        return moved(sensor.truth()[person].joints, sensor.floorFromCamera());
      };
      straight[p] = apart(frame, truth(crossed ? 1 - p : p));
      exchanged[p] = apart(frame, truth(crossed ? p : 1 - p));
    }
    const bool both = straight[0] && straight[1];
    if (both && !result.bothSince) {
      result.bothSince = result.frames;
      crossed = *exchanged[0] + *exchanged[1] < *straight[0] + *straight[1];
      if (crossed) std::swap(straight, exchanged);
    }
    ++result.frames;
    if (!result.bothSince) continue;
    result.lost += both ? 0 : 1;
    bool wrong = false;
    for (std::size_t p = 0; p < 2; ++p) {
      if (!straight[p]) continue;
      wrong |= *exchanged[p] < *straight[p];
      result.errorMm += 1e3 * *straight[p];
      ++errors;
    }
    result.exchanged += wrong ? 1 : 0;
  }
  result.errorMm /= std::max(1, errors);
  return followed;
}

/// Two closed surfaces.
struct Skins {
  std::array<std::span<const Vec3>, 2> points;
  std::array<TriangleTree, 2> trees;

  Skins(std::span<const Vec3> first, std::span<const Triangle> firstTriangles, std::span<const Vec3> second,
        std::span<const Triangle> secondTriangles)
      : points{first, second}, trees{TriangleTree(first, firstTriangles), TriangleTree(second, secondTriangles)} {}
};

/// How near two skins are to each other [m]: 0 if a vertex of one is inside the other; and how deep such a vertex is.
struct Nearness {
  double apart = std::numeric_limits<double>::infinity(), deep = 0.0;

  explicit Nearness(const Skins& skins) {
    for (std::size_t s = 0; s < 2; ++s) {
      for (const Vec3& p : skins.points[s]) {
        const TriangleTree& other = skins.trees[1 - s];
        const TriangleTree::Hit hit = other.nearest(p, 3.0 * kTolerance, [](std::int32_t) { return true; });
        if (!std::isfinite(hit.distance)) continue;
        const bool within = other.windingNumber(p) > 0.5;
        apart = std::min(apart, within ? 0.0 : hit.distance);
        if (within) deep = std::max(deep, hit.distance);
      }
    }
  }
};

/// Distance from a point to the farther one of two skins, 0 inside [m].
double distanceTo(const Skins& skins, const Vec3& point) {
  double farther = 0.0;
  for (const TriangleTree& tree : skins.trees) {
    if (tree.windingNumber(point) < 0.5) farther = std::max(farther, tree.distance(point));
  }
  return farther;
}

std::span<const Vec3> skinOf(const SessionAvatar& avatar) {
  return avatar.points().first(avatar.character().mesh.vertices.size());
}

void compare(const Session& session, MeetingResult& result) {
  const std::span<const BodyContact> contacts = session.avatarContacts();
  const std::vector<Triangle>& triangles = session.character().mesh.triangles;
  const Skins skins(skinOf(session.avatar(0)), triangles, skinOf(session.avatar(1)), triangles);
  const Nearness nearness(skins);
  const bool touch = nearness.apart == 0.0, contact = !contacts.empty();
  ++result.compared;
  result.touching += touch ? 1 : 0;
  result.contacts += contact ? 1 : 0;
  if (touch && !contact) {
    ++result.missed;
    result.missed2cm += nearness.deep > kTolerance ? 1 : 0;
    result.deepestMissedMm = std::max(result.deepestMissedMm, 1e3 * nearness.deep);
  } else if (contact && !touch) {
    ++result.wrong;
    result.wrong2cm += nearness.apart > kTolerance ? 1 : 0;
    result.farthestWrongMm = std::max(result.farthestWrongMm, 1e3 * nearness.apart);
  }
  for (const BodyContact& one : contacts) {
    ++result.points;
    result.pointsOff2cm += distanceTo(skins, one.position) > kTolerance ? 1 : 0;
  }
}

/// What the people's own skins do in the same frame.
void compareWithPeople(std::array<VirtualPerformer, 2>& people, double time, bool contact, MeetingResult& result) {
  for (VirtualPerformer& one : people) one.pose(time, Isometry3::Identity());
  const Nearness nearness(
      Skins(people[0].positions(), people[0].triangles(), people[1].positions(), people[1].triangles()));
  if (nearness.deep <= kTolerance) return;
  ++result.peopleTouch;
  result.peopleTouchMissed += contact ? 0 : 1;
}

}  // namespace

Result<MeetingResult> runMeeting(const Meeting& meeting, const Decomposition& parts, const MeetingSettings& settings) {
  Result<VirtualSensor> sensor = sensorBefore(meeting, settings);
  if (!sensor) return sensor.error();
  Result<std::array<VirtualPerformer, 2>> people = performersOf(meeting);
  if (!people) return people.error();
  MeetingResult result;
  Result<TwoOf> followed = follow(*sensor, result);
  if (!followed) return followed.error();
  Session session{World()};
  const Character character = makeMannequin();
  for (std::vector<SkeletonFrame>& frames : *followed) {
    Result<std::unique_ptr<PoseSource>> source =
        makeTreatedSource(character, makeRecordedSource(std::move(frames)), SourceTreatment());
    if (!source) return source.error();
    Result<SessionAvatar> avatar = SessionAvatar::create(character, parts, std::move(*source));
    if (!avatar) return avatar.error();
    session.addAvatar(std::move(*avatar));
  }
  for (int frame = 0;; ++frame) {
    const Result<bool> more = session.step();
    if (!more) return more.error();
    if (!*more) return result;
    if (frame % settings.every != 0 || !session.avatar(0).present() || !session.avatar(1).present()) continue;
    compare(session, result);
    compareWithPeople(*people, session.time(), !session.avatarContacts().empty(), result);
  }
}

}  // namespace lorica::test
