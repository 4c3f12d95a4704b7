#include "capture/motion_retarget.h"

#include "capture/foot_contacts.h"
#include "capture/human_motion.h"
#include "capture/leg_reach.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lorica {
namespace {

/// How long a foot takes from its own way to the place where it stands, and back [s].
constexpr double kBlendSeconds = 0.15;
/// The root is lowered for legs that are too short within this time, either side [s].
constexpr double kNudgeSeconds = 0.15;
/// And at most by this share of the leg.
constexpr double kLargestNudge = 0.15;
/// Feet this far above the floor no longer say how high the body is, of the leg's length.
constexpr double kFeetSayHeight = 0.3;
constexpr double kFeetSayNothing = 0.8;

double smoothStep(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

Vec3 mirrored(const Vec3& v) {
  return {-v.x(), v.y(), v.z()};
}
Quat mirrored(const Quat& q) {
  return {q.w(), q.x(), -q.y(), -q.z()};
}

FootPlace mirrored(const FootPlace& foot) {
  return {mirrored(foot.ankle), mirrored(foot.ball), foot.lowest};
}

HumanPose mirrored(const HumanPose& pose) {
  HumanPose out;
  for (std::size_t i = 0; i < pose.turn.size(); ++i) {
    const std::optional<Quat>& other = pose[otherSide(static_cast<HumanBone>(i))];
    if (other) out.turn[i] = mirrored(*other);
  }
  out.middleHip = mirrored(pose.middleHip);
  out.foot = {mirrored(pose.foot[1]), mirrored(pose.foot[0])};
  return out;
}

class MotionRetargeter {
 public:
  MotionRetargeter(const SkeletalMotion& source, HumanBody from, HumanBody to, const MotionRetargetSettings& settings)
      : source_(source), from_(std::move(from)), to_(std::move(to)), settings_(settings) {}

  SkeletalMotion run() {
    out_.name = source_.name;
    out_.skeleton = to_.rig().skeleton;
    out_.times = source_.times;
    jointCount_ = static_cast<std::size_t>(out_.skeleton.jointCount());
    out_.poses.resize(out_.times.size() * jointCount_);
    ratio_ = to_.rig().legLength / from_.rig().legLength;
    takeTurns();
    standOnFloor();
    if (settings_.plantFeet) plantFeet();
    return std::move(out_);
  }

 private:
  using Feet = std::array<FootPlace, 2>;

  [[nodiscard]] std::span<JointTransform> pose(std::size_t frame) {
    return std::span(out_.poses).subspan(frame * jointCount_, jointCount_);
  }
  [[nodiscard]] std::size_t frameCount() const { return out_.times.size(); }

  /// Bones take the source's turns; the hips stay at rest for now.
  void takeTurns() {
    sourceHip_.reserve(frameCount());
    sourceFeet_.reserve(frameCount());
    for (std::size_t f = 0; f < frameCount(); ++f) {
      HumanPose human = from_.read(source_.pose(static_cast<int>(f)));
      if (settings_.mirror) human = mirrored(human);
      sourceHip_.push_back(human.middleHip);
      sourceFeet_.push_back(human.foot);
      to_.pose(human, from_.spineTurnsOf(human), pose(f));
      hipAsPosed_.push_back(to_.middleHip());
      feetAsPosed_.push_back({to_.footPlace(0), to_.footPlace(1)});
    }
    std::array<std::vector<FootPlace>, 2> places;
    for (std::size_t side = 0; side < 2; ++side) {
      places[side].reserve(frameCount());
      for (const Feet& feet : sourceFeet_) places[side].push_back(feet[side]);
    }
    floor_ = floorUnder(places[0], places[1]);
    for (std::size_t side = 0; side < 2; ++side) {
      contacts_[side] = contactsOf(places[side], source_.times, floor_, from_.rig().legLength);
    }
  }

  /// Height of a sole that the source asks for [m].
  [[nodiscard]] double wantedSole(std::size_t frame, std::size_t side) const {
    return ratio_ * std::max(0.0, sourceFeet_[frame][side].lowest - floor_);
  }

  /// The root follows the source's, scaled; its height puts the lower foot as high as the source's is, scaled.
  void standOnFloor() {
    std::vector<double> lift;
    std::vector<double> weight;
    lift.reserve(frameCount());
    weight.reserve(frameCount());
    double sum = 0.0;
    double weights = 0.0;
    const Vec3 start = sourceHip_.front();
    root_.reserve(frameCount());
    for (std::size_t f = 0; f < frameCount(); ++f) {
      Vec3 place = start + ratio_ * (sourceHip_[f] - start);
      place.y() = ratio_ * (sourceHip_[f].y() - floor_);
      root_.push_back(place);
      const auto soleOf = [&](std::size_t side) {
        return place.y() + feetAsPosed_[f][side].lowest - hipAsPosed_[f].y();
      };
      // The minimum over the feet of both is continuous: stepping from foot to foot shows no jump.
      const double wanted = std::min(wantedSole(f, 0), wantedSole(f, 1));
      lift.push_back(wanted - std::min(soleOf(0), soleOf(1)));
      const double leg = to_.rig().legLength;
      weight.push_back(1.0 - smoothStep(kFeetSayHeight * leg, kFeetSayNothing * leg, wanted));
      sum += weight.back() * lift.back();
      weights += weight.back();
    }
    const double usual = weights > 0.0 ? sum / weights : 0.0;
    for (std::size_t f = 0; f < frameCount(); ++f) {
      root_[f].y() += weight[f] * lift[f] + (1.0 - weight[f]) * usual;
      const Vec3 by = root_[f] - hipAsPosed_[f];
      pose(f)[static_cast<std::size_t>(to_.rig().hips)].translation += to_.rig().hipsParentFromWorld.linear() * by;
      for (FootPlace& foot : feetAsPosed_[f]) {
        foot.ankle += by;
        foot.ball += by;
        foot.lowest += by.y();
      }
    }
  }

  /// Where an ankle goes in a stance: as the source's does, scaled, from where the stance has it in the mean. So a
  /// foot that stands still there stands still here. Its height keeps the sole as high as the source's, scaled.
  [[nodiscard]] Vec3 standingAnkle(std::size_t frame, std::size_t side, const Vec3& meanOffset) const {
    Vec3 ankle = meanOffset + ratio_ * sourceFeet_[frame][side].ankle;
    const FootPlace& foot = feetAsPosed_[frame][side];
    ankle.y() = foot.ankle.y() - foot.lowest + wantedSole(frame, side);
    return ankle;
  }

  /// What is added to each ankle's place, a frame.
  [[nodiscard]] std::vector<Vec3> correctionsOf(std::size_t side) const {
    std::vector<Vec3> corrections(frameCount(), Vec3::Zero());
    for (const FootContact& contact : contacts_[side]) {
      const auto first = static_cast<std::size_t>(contact.first);
      const auto last = static_cast<std::size_t>(contact.last);
      Vec3 offset = Vec3::Zero();
      for (std::size_t f = first; f <= last; ++f) {
        offset += feetAsPosed_[f][side].ankle - ratio_ * sourceFeet_[f][side].ankle;
      }
      offset /= static_cast<double>(last - first + 1);
      for (std::size_t f = first; f <= last; ++f) {
        corrections[f] = standingAnkle(f, side, offset) - feetAsPosed_[f][side].ankle;
      }
    }
    // Between two stances a correction fades out and the next one fades in; when there is little time, one into the
    // other.
    const std::vector<FootContact>& contacts = contacts_[side];
    for (std::size_t i = 0; i <= contacts.size(); ++i) {
      const bool hasBefore = i > 0;
      const bool hasAfter = i < contacts.size();
      const std::size_t from = hasBefore ? static_cast<std::size_t>(contacts[i - 1].last) + 1 : 0;
      const std::size_t to = hasAfter ? static_cast<std::size_t>(contacts[i].first) : frameCount();
      double blend = kBlendSeconds;
      if (hasBefore && hasAfter) {
        const double gap = out_.times[to] - out_.times[from - 1];
        if (gap < 2.0 * blend) blend = gap;
      }
      for (std::size_t f = from; f < to; ++f) {
        Vec3 sum = Vec3::Zero();
        if (hasBefore) {
          const double since = out_.times[f] - out_.times[from - 1];
          sum += (1.0 - smoothStep(0.0, blend, since)) * corrections[from - 1];
        }
        if (hasAfter) {
          const double until = out_.times[to] - out_.times[f];
          sum += (1.0 - smoothStep(0.0, blend, until)) * corrections[to];
        }
        corrections[f] = sum;
      }
    }
    return corrections;
  }

  /// How far the root must come down so that both legs reach, smoothed: the largest need nearby, then its mean.
  [[nodiscard]] std::vector<double> nudges(const std::array<std::vector<Vec3>, 2>& ankles) {
    std::vector<double> need(frameCount(), 0.0);
    for (std::size_t f = 0; f < frameCount(); ++f) {
      to_.move(Vec3::Zero(), pose(f));
      for (std::size_t side = 0; side < 2; ++side) {
        const LimbBones& leg = limbs()[kFirstLeg + side];
        need[f] = std::max(need[f], dropToReach(to_.placeOf(leg.upper), to_.placeOf(leg.lower), to_.placeOf(leg.end),
                                                ankles[side][f]));
      }
      need[f] = std::clamp(need[f], 0.0, kLargestNudge * to_.rig().legLength);
    }
    const auto nearby = [&](const std::vector<double>& values, auto&& merge) {
      std::vector<double> out(values.size());
      std::size_t first = 0;
      std::size_t end = 0;
      for (std::size_t f = 0; f < values.size(); ++f) {
        while (out_.times[first] < out_.times[f] - kNudgeSeconds) ++first;
        while (end < values.size() && out_.times[end] <= out_.times[f] + kNudgeSeconds) ++end;
        out[f] = merge(std::span(values).subspan(first, end - first));
      }
      return out;
    };
    const std::vector<double> largest =
        nearby(need, [](std::span<const double> v) { return *std::max_element(v.begin(), v.end()); });
    return nearby(largest, [](std::span<const double> v) {
      double sum = 0.0;
      for (const double x : v) sum += x;
      return sum / static_cast<double>(v.size());
    });
  }

  void plantFeet() {
    std::array<std::vector<Vec3>, 2> ankles;
    for (std::size_t side = 0; side < 2; ++side) {
      ankles[side] = correctionsOf(side);
      for (std::size_t f = 0; f < frameCount(); ++f) {
        const FootPlace& foot = feetAsPosed_[f][side];
        Vec3& ankle = ankles[side][f];
        ankle += foot.ankle;
        // No sole goes under the floor: limbs of other lengths may have put it there.
        ankle.y() = std::max(ankle.y(), foot.ankle.y() - foot.lowest);
      }
    }
    const std::vector<double> down = nudges(ankles);
    for (std::size_t f = 0; f < frameCount(); ++f) {
      to_.move(Vec3(0.0, -down[f], 0.0), pose(f));
      for (std::size_t side = 0; side < 2; ++side) to_.reach(side, ankles[side][f], pose(f));
    }
  }

  const SkeletalMotion& source_;
  HumanBody from_;
  HumanBody to_;
  MotionRetargetSettings settings_;
  SkeletalMotion out_;
  std::size_t jointCount_ = 0;
  double ratio_ = 1.0;
  double floor_ = 0.0;
  std::vector<Vec3> sourceHip_;
  std::vector<Feet> sourceFeet_;
  std::array<std::vector<FootContact>, 2> contacts_;
  std::vector<Vec3> hipAsPosed_;
  std::vector<Feet> feetAsPosed_;
  std::vector<Vec3> root_;  ///< middle of the hips
};

}  // namespace

Result<SkeletalMotion> retargetMotion(const SkeletalMotion& source, const Skeleton& target,
                                      const MotionRetargetSettings& settings) {
  const auto joints = static_cast<std::size_t>(source.skeleton.jointCount());
  if (source.times.empty() || source.poses.size() != source.times.size() * joints) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("the motion {} has {} joint transforms, expected {} frames of {}, and one frame at least",
                             source.name, source.poses.size(), source.times.size(), joints)};
  }
  Result<HumanBody> from = HumanBody::create(source.skeleton);
  if (!from) return Error{from.error().code, fmt::format("the motion {}: {}", source.name, from.error().message)};
  Result<HumanBody> to = HumanBody::create(target);
  if (!to) return Error{to.error().code, fmt::format("the character: {}", to.error().message)};
  return MotionRetargeter(source, std::move(*from), std::move(*to), settings).run();
}

}  // namespace lorica
