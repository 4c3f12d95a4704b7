#include "bench/meeting_moves.h"

#include "capture/synthetic/motion_clips.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

namespace lorica::bench {
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

}  // namespace lorica::bench
