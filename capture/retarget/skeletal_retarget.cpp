#include "capture/retarget/skeletal_retarget.h"

#include "capture/retarget/completed_skeleton.h"
#include "capture/retarget/foot_contacts.h"
#include "capture/retarget/human_rig.h"
#include "capture/retarget/leg_reach.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

namespace lorica {
namespace {

/// How long a foot takes from its own way to the place where it stands, and back [s].
constexpr double kBlendSeconds = 0.15;
/// A standing sole may be this much too high or low, of the leg's length: 5 mm.
constexpr double kSoleTolerance = 0.006;
/// An ankle that moves by less from frame to frame does not roll on the ball of the foot, of the leg's length: 0.3 mm.
constexpr double kRollStill = 0.0004;
/// The root's way is smoothed over this time, either side, twice [s].
constexpr double kShiftSeconds = 0.1;
/// The root is lowered for legs that are too short within this time, either side [s].
constexpr double kNudgeSeconds = 0.15;
/// And at most by this share of the leg.
constexpr double kLargestNudge = 0.15;
/// Feet this far above the floor no longer say how high the body is, of the leg's length.
constexpr double kFeetSayHeight = 0.3;
constexpr double kFeetSayNothing = 0.8;

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
  /// @param source  on the completed skeleton
  MotionRetargeter(const SkeletalMotion& source, const CompletedSkeleton& completed, HumanBody from, HumanBody to,
                   const MotionRetargetSettings& settings)
      : source_(source), completed_(completed), from_(std::move(from)), to_(std::move(to)), settings_(settings) {
    knowsFeet_ = completed_.knowsPlaceOf(limbs()[kFirstLeg].end) && completed_.knowsPlaceOf(limbs()[kFirstLeg + 1].end);
  }

  SkeletalMotion run() {
    out_.name = source_.name;
    out_.skeleton = to_.rig().skeleton;
    out_.times = source_.times;
    jointCount_ = static_cast<std::size_t>(out_.skeleton.jointCount());
    out_.poses.resize(out_.times.size() * jointCount_);
    ratio_ = to_.rig().legLength / from_.rig().legLength;
    takeTurns();
    standOnFloor();
    if (settings_.plantFeet && knowsFeet_) plantFeet();
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
      for (std::size_t b = 0; b < human.turn.size(); ++b) {
        if (!completed_.speaksOf(static_cast<HumanBone>(b))) human.turn[b].reset();
      }
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

  /// Height of a sole that the source asks for; of a source without legs, that of one who stands [m].
  [[nodiscard]] double wantedSole(std::size_t frame, std::size_t side) const {
    if (!knowsFeet_) return 0.0;
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
  /// foot that stands still there stands still here. Its height keeps the sole about as high as the source's, scaled.
  [[nodiscard]] Vec3 standingAnkle(std::size_t frame, std::size_t side, const Vec3& meanOffset) const {
    Vec3 ankle = meanOffset + ratio_ * sourceFeet_[frame][side].ankle;
    const FootPlace& foot = feetAsPosed_[frame][side];
    // Legs that are nearly straight bend by degrees for millimetres, so a height that is about right stays.
    const double wanted = wantedSole(frame, side);
    const double tolerance = kSoleTolerance * to_.rig().legLength;
    const double sole = std::clamp(foot.lowest, std::max(0.0, wanted - tolerance), wanted + tolerance);
    ankle.y() = foot.ankle.y() - foot.lowest + sole;
    return ankle;
  }

  /// How far the ankle goes in a step of a stance beyond the source's, scaled, so that the ball of the foot stands
  /// where the source's does: feet of other lengths roll on it in other circles. As much of that as the source's foot
  /// turns about its ball and not about its heel.
  [[nodiscard]] Vec3 rollOf(std::size_t frame, std::size_t side) const {
    const FootPlace& before = sourceFeet_[frame - 1][side];
    const FootPlace& now = sourceFeet_[frame][side];
    const auto level = [](const Vec3& v) { return Vec3(v.x(), 0.0, v.z()); };
    const double ankleSq = level(now.ankle - before.ankle).squaredNorm();
    const double ballSq = level(now.ball - before.ball).squaredNorm();
    const double still = kRollStill * from_.rig().legLength;
    const double share = ankleSq / (ankleSq + ballSq + still * still);
    const auto behindBall = [&](std::size_t f) -> Vec3 {
      const FootPlace& source = sourceFeet_[f][side];
      const FootPlace& own = feetAsPosed_[f][side];
      return level(ratio_ * (source.ball - source.ankle) - (own.ball - own.ankle));
    };
    return share * (behindBall(frame) - behindBall(frame - 1));
  }

  /// What a stance adds to its ankle's place; nothing where the foot does not stand.
  [[nodiscard]] std::vector<std::optional<Vec3>> pullsOf(std::size_t side) const {
    std::vector<std::optional<Vec3>> pulls(frameCount());
    for (const FootContact& contact : contacts_[side]) {
      const auto first = static_cast<std::size_t>(contact.first);
      const auto last = static_cast<std::size_t>(contact.last);
      Vec3 offset = Vec3::Zero();
      std::vector<Vec3> rolled = {Vec3::Zero()};
      rolled.reserve(last - first + 1);
      for (std::size_t f = first; f <= last; ++f) {
        if (f > first) rolled.push_back(rolled.back() + rollOf(f, side));
        offset += feetAsPosed_[f][side].ankle - ratio_ * sourceFeet_[f][side].ankle - rolled.back();
      }
      offset /= static_cast<double>(last - first + 1);
      for (std::size_t f = first; f <= last; ++f) {
        pulls[f] = standingAnkle(f, side, offset + rolled[f - first]) - feetAsPosed_[f][side].ankle;
      }
    }
    return pulls;
  }

  /// For each frame, what a function makes of the values within a time around it, either side.
  template <typename Value, typename Merge>
  [[nodiscard]] std::vector<Value> nearby(const std::vector<Value>& values, double seconds, Merge&& merge) const {
    std::vector<Value> out;
    out.reserve(values.size());
    std::size_t first = 0;
    std::size_t end = 0;
    for (std::size_t f = 0; f < values.size(); ++f) {
      while (out_.times[first] < out_.times[f] - seconds) ++first;
      while (end < values.size() && out_.times[end] <= out_.times[f] + seconds) ++end;
      out.push_back(merge(std::span(values).subspan(first, end - first)));
    }
    return out;
  }

  template <typename Value>
  [[nodiscard]] std::vector<Value> smoothed(const std::vector<Value>& values, double seconds) const {
    return nearby(values, seconds, [](std::span<const Value> v) {
      Value sum = v.front();
      for (const Value& x : v.subspan(1)) sum += x;
      return Value(sum / static_cast<double>(v.size()));
    });
  }

  /// Moves the root along with what the standing feet ask for in the mean, smoothly: legs then point as the source's,
  /// and little is left for them to bend.
  [[nodiscard]] std::vector<Vec3> rootShifts(const std::array<std::vector<std::optional<Vec3>>, 2>& pulls) const {
    std::vector<Vec3> shifts(frameCount(), Vec3::Zero());
    std::optional<std::size_t> before;
    for (std::size_t f = 0; f < frameCount(); ++f) {
      const std::optional<Vec3>& left = pulls[0][f];
      const std::optional<Vec3>& right = pulls[1][f];
      if (!left && !right) continue;
      shifts[f] = left && right ? Vec3(0.5 * (*left + *right)) : left ? *left : *right;
      shifts[f].y() = 0.0;
      // In the air on the straight line from one stance to the next.
      for (std::size_t g = before ? *before + 1 : 0; g < f; ++g) {
        const double share =
            before ? (out_.times[g] - out_.times[*before]) / (out_.times[f] - out_.times[*before]) : 1.0;
        const Vec3 from = before ? shifts[*before] : shifts[f];
        shifts[g] = from + share * (shifts[f] - from);
      }
      before = f;
    }
    if (before) std::fill(shifts.begin() + static_cast<std::ptrdiff_t>(*before), shifts.end(), shifts[*before]);
    return smoothed(smoothed(shifts, kShiftSeconds), kShiftSeconds);
  }

  /// What is added to each ankle's place beyond the root's shift: in a stance what its pull asks for, between two
  /// stances that of the one fades out and that of the next fades in; when there is little time, one into the other.
  [[nodiscard]] std::vector<Vec3> bendsOf(std::size_t side, const std::vector<std::optional<Vec3>>& pulls,
                                          const std::vector<Vec3>& shifts) const {
    std::vector<Vec3> bends(frameCount(), Vec3::Zero());
    for (std::size_t f = 0; f < frameCount(); ++f) {
      if (pulls[f]) bends[f] = *pulls[f] - shifts[f];
    }
    const std::vector<FootContact>& contacts = contacts_[side];
    for (std::size_t i = 0; i <= contacts.size(); ++i) {
      const bool hasBefore = i > 0;
      const bool hasAfter = i < contacts.size();
      const std::size_t from = hasBefore ? static_cast<std::size_t>(contacts[i - 1].last) + 1 : 0;
      const std::size_t to = hasAfter ? static_cast<std::size_t>(contacts[i].first) : frameCount();
      double blend = kBlendSeconds;
      if (hasBefore && hasAfter) blend = std::min(blend, out_.times[to] - out_.times[from - 1]);
      for (std::size_t f = from; f < to; ++f) {
        if (hasBefore) {
          const double since = out_.times[f] - out_.times[from - 1];
          bends[f] += (1.0 - smoothStep(0.0, blend, since)) * bends[from - 1];
        }
        if (hasAfter) {
          const double until = out_.times[to] - out_.times[f];
          bends[f] += (1.0 - smoothStep(0.0, blend, until)) * bends[to];
        }
      }
    }
    return bends;
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
      need[f] = std::min(need[f], kLargestNudge * to_.rig().legLength);
    }
    const std::vector<double> largest =
        nearby(need, kNudgeSeconds, [](std::span<const double> v) { return *std::max_element(v.begin(), v.end()); });
    return smoothed(largest, kNudgeSeconds);
  }

  void plantFeet() {
    const std::array<std::vector<std::optional<Vec3>>, 2> pulls = {pullsOf(0), pullsOf(1)};
    const std::vector<Vec3> shifts = rootShifts(pulls);
    std::array<std::vector<Vec3>, 2> ankles;
    for (std::size_t side = 0; side < 2; ++side) {
      ankles[side] = bendsOf(side, pulls[side], shifts);
      for (std::size_t f = 0; f < frameCount(); ++f) {
        const FootPlace& foot = feetAsPosed_[f][side];
        Vec3& ankle = ankles[side][f];
        ankle += foot.ankle + shifts[f];
        // No sole goes under the floor: limbs of other lengths may have put it there.
        ankle.y() = std::max(ankle.y(), foot.ankle.y() - foot.lowest);
      }
    }
    for (std::size_t f = 0; f < frameCount(); ++f) to_.move(shifts[f], pose(f));
    const std::vector<double> down = nudges(ankles);
    for (std::size_t f = 0; f < frameCount(); ++f) {
      to_.move(Vec3(0.0, -down[f], 0.0), pose(f));
      for (std::size_t side = 0; side < 2; ++side) to_.reach(side, ankles[side][f], pose(f));
    }
  }

  const SkeletalMotion& source_;
  const CompletedSkeleton& completed_;
  bool knowsFeet_ = true;
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
  const Result<CompletedSkeleton> completed = CompletedSkeleton::create(source.skeleton);
  if (!completed) {
    return Error{completed.error().code, fmt::format("the motion {}: {}", source.name, completed.error().message)};
  }
  Result<HumanBody> from = HumanBody::create(completed->skeleton());
  if (!from) return Error{from.error().code, fmt::format("the motion {}: {}", source.name, from.error().message)};
  Result<HumanBody> to = HumanBody::create(target);
  if (!to) return Error{to.error().code, fmt::format("the character: {}", to.error().message)};
  if (completed->isWhole()) {
    return MotionRetargeter(source, *completed, std::move(*from), std::move(*to), settings).run();
  }
  return MotionRetargeter(completed->complete(source), *completed, std::move(*from), std::move(*to), settings).run();
}

Result<std::vector<HumanBone>> bonesLeftAtRest(const Skeleton& source) {
  const Result<CompletedSkeleton> completed = CompletedSkeleton::create(source);
  if (!completed) return completed.error();
  std::vector<HumanBone> bones;
  for (int b = 0; b < kHumanBoneCount; ++b) {
    if (!completed->speaksOf(static_cast<HumanBone>(b))) bones.push_back(static_cast<HumanBone>(b));
  }
  return bones;
}

}  // namespace lorica
