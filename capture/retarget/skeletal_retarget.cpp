#include "capture/retarget/skeletal_retarget.h"

#include "capture/retarget/completed_skeleton.h"
#include "capture/retarget/human_rig.h"
#include "capture/retarget/mirrored_axes.h"
#include "capture/retarget/proxy_skeleton.h"
#include "geometry/errors.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>

namespace lorica {
namespace {

/// Blend time of a foot from its own path to its stance position, and back [s].
constexpr double kBlendSeconds = 0.15;
/// A standing sole may be this much too high or low, as a fraction of leg length: 5 mm.
constexpr double kSoleTolerance = 0.006;
/// An ankle that moves less than this per frame does not roll on the ball of the foot, as a fraction of leg length: 0.3
/// mm.
constexpr double kRollStill = 0.0004;
/// The root's path is smoothed over this time on either side, twice [s].
constexpr double kShiftSeconds = 0.1;
/// The root is lowered for legs that are too short within this time on either side [s].
constexpr double kNudgeSeconds = 0.15;
/// Max lowering, as a fraction of leg length.
constexpr double kLargestNudge = 0.15;
/// Range of foot heights above the floor over which the feet's influence on the body's height fades out, as a fraction
/// of leg length.
constexpr double kFeetSayHeight = 0.3;
constexpr double kFeetSayNothing = 0.8;

using lorica::mirrored;  // positions and rotations

FootPosition mirrored(const FootPosition& foot) {
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

class SkeletalRetargeter {
 public:
  /// @param source  on the completed skeleton
  SkeletalRetargeter(const SkeletalMotion& source, const CompletedSkeleton& completed, HumanRig from, HumanRig to,
                     const SkeletalRetargetSettings& settings)
      : source_(source), completed_(completed), from_(std::move(from)), to_(std::move(to)), settings_(settings) {
    knowsFeet_ =
        completed_.knowsPositionOf(limbs()[kFirstLeg].end) && completed_.knowsPositionOf(limbs()[kFirstLeg + 1].end);
  }

  SkeletalMotion run() {
    out_.name = source_.name;
    out_.skeleton = to_.rig.skeleton;
    out_.times = source_.times;
    jointCount_ = static_cast<std::size_t>(out_.skeleton.jointCount());
    out_.poses.resize(out_.times.size() * jointCount_);
    ratio_ = to_.rig.legLength / from_.rig.legLength;
    takeTurns();
    standOnFloor();
    if (settings_.plantFeet && knowsFeet_) plantFeet();
    return std::move(out_);
  }

 private:
  using Feet = std::array<FootPosition, 2>;

  [[nodiscard]] std::span<JointTransform> pose(std::size_t frame) {
    return std::span(out_.poses).subspan(frame * jointCount_, jointCount_);
  }
  [[nodiscard]] std::size_t frameCount() const { return out_.times.size(); }

  /// Bones take the source's rotations; the hips stay at rest for now.
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
      feetAsPosed_.push_back({to_.foot(0), to_.foot(1)});
    }
    std::array<std::vector<FootPosition>, 2> positions;
    for (std::size_t side = 0; side < 2; ++side) {
      positions[side].reserve(frameCount());
      for (const Feet& feet : sourceFeet_) positions[side].push_back(feet[side]);
    }
    floor_ = floorUnder(positions, source_.times, from_.rig.legLength);
    for (std::size_t side = 0; side < 2; ++side) {
      contacts_[side] = contactsOf(positions[side], source_.times, floor_, from_.rig.legLength);
    }
  }

  /// Height of a sole according to the source; for a source without legs, that of a standing person [m].
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
      const Vec3 position = scaledPath(start, sourceHip_[f], ratio_, floor_);
      root_.push_back(position);
      const auto soleOf = [&](std::size_t side) {
        return position.y() + feetAsPosed_[f][side].lowest - hipAsPosed_[f].y();
      };
      // The minimum over both feet is continuous: stepping from foot to foot causes no jump.
      const double wanted = std::min(wantedSole(f, 0), wantedSole(f, 1));
      lift.push_back(wanted - std::min(soleOf(0), soleOf(1)));
      const double leg = to_.rig.legLength;
      weight.push_back(1.0 - smoothStep(kFeetSayHeight * leg, kFeetSayNothing * leg, wanted));
      sum += weight.back() * lift.back();
      weights += weight.back();
    }
    const double usual = weights > 0.0 ? sum / weights : 0.0;
    for (std::size_t f = 0; f < frameCount(); ++f) {
      root_[f].y() += weight[f] * lift[f] + (1.0 - weight[f]) * usual;
      const Vec3 by = root_[f] - hipAsPosed_[f];
      to_.moveHips(by, pose(f));
      for (FootPosition& foot : feetAsPosed_[f]) {
        foot.ankle += by;
        foot.ball += by;
        foot.lowest += by.y();
      }
    }
  }

  /// Target position of an ankle in a stance: moves like the source's, scaled, around the mean position of the stance.
  /// A foot that stands still in the source therefore stands still in the target. The sole is about as high as the
  /// source's, scaled.
  [[nodiscard]] Vec3 standingAnkle(std::size_t frame, std::size_t side, const Vec3& meanOffset) const {
    Vec3 ankle = meanOffset + ratio_ * sourceFeet_[frame][side].ankle;
    const FootPosition& foot = feetAsPosed_[frame][side];
    // Legs that are nearly straight bend by degrees for millimetres, so a height within the tolerance is kept.
    const double wanted = wantedSole(frame, side);
    const double tolerance = kSoleTolerance * to_.rig.legLength;
    const double sole = std::clamp(foot.lowest, std::max(0.0, wanted - tolerance), wanted + tolerance);
    ankle.y() = foot.ankle.y() - foot.lowest + sole;
    return ankle;
  }

  /// Extra motion of the ankle in one step of a stance, in addition to the source's scaled motion, so that the ball of
  /// the foot stands still if the source's does: feet of other lengths roll on other circles. Weighted by how much the
  /// source's foot rotates about its ball instead of its heel.
  [[nodiscard]] Vec3 rollOf(std::size_t frame, std::size_t side) const {
    const FootPosition& before = sourceFeet_[frame - 1][side];
    const FootPosition& now = sourceFeet_[frame][side];
    const auto level = [](const Vec3& v) { return Vec3(v.x(), 0.0, v.z()); };
    const double ankleSq = level(now.ankle - before.ankle).squaredNorm();
    const double ballSq = level(now.ball - before.ball).squaredNorm();
    const double still = kRollStill * from_.rig.legLength;
    const double share = ankleSq / (ankleSq + ballSq + still * still);
    const auto behindBall = [&](std::size_t f) -> Vec3 {
      const FootPosition& source = sourceFeet_[f][side];
      const FootPosition& own = feetAsPosed_[f][side];
      return level(ratio_ * (source.ball - source.ankle) - (own.ball - own.ankle));
    };
    return share * (behindBall(frame) - behindBall(frame - 1));
  }

  /// Offset that a stance adds to its ankle's position; nullopt if the foot does not stand.
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

  /// For each frame, applies a function to the values within a time window on either side.
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

  /// Moves the root with the mean correction of the standing feet, smoothly. Legs then point as the source's do and
  /// bend little for the rest.
  [[nodiscard]] std::vector<Vec3> rootShifts(const std::array<std::vector<std::optional<Vec3>>, 2>& pulls) const {
    std::vector<Vec3> shifts(frameCount(), Vec3::Zero());
    std::optional<std::size_t> before;
    for (std::size_t f = 0; f < frameCount(); ++f) {
      const std::optional<Vec3>& left = pulls[0][f];
      const std::optional<Vec3>& right = pulls[1][f];
      if (!left && !right) continue;
      shifts[f] = left && right ? Vec3(0.5 * (*left + *right)) : left ? *left : *right;
      shifts[f].y() = 0.0;
      // In the air: interpolate linearly from one stance to the next.
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

  /// Correction of each ankle's position in addition to the root's shift. In a stance it is what its pull requires;
  /// between two stances the first fades out and the next fades in, or they cross-fade if there is little time.
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

  /// How far the root must be lowered so that both legs reach, smoothed: the nearby maximum, then its mean.
  [[nodiscard]] std::vector<double> nudges(const std::array<std::vector<Vec3>, 2>& ankles) {
    std::vector<double> need(frameCount(), 0.0);
    for (std::size_t f = 0; f < frameCount(); ++f) {
      to_.evaluate(pose(f));
      for (std::size_t side = 0; side < 2; ++side) {
        const LimbBones& leg = limbs()[kFirstLeg + side];
        need[f] = std::max(need[f], dropToReach(to_.positionOf(leg.upper), to_.positionOf(leg.lower),
                                                to_.positionOf(leg.end), ankles[side][f]));
      }
      need[f] = std::min(need[f], kLargestNudge * to_.rig.legLength);
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
        const FootPosition& foot = feetAsPosed_[f][side];
        Vec3& ankle = ankles[side][f];
        ankle += foot.ankle + shifts[f];
        // No sole goes below the floor: limbs of other lengths may have put it there.
        ankle.y() = std::max(ankle.y(), foot.ankle.y() - foot.lowest);
      }
    }
    for (std::size_t f = 0; f < frameCount(); ++f) to_.moveHips(shifts[f], pose(f));
    const std::vector<double> down = nudges(ankles);
    for (std::size_t f = 0; f < frameCount(); ++f) {
      to_.moveHips(Vec3(0.0, -down[f], 0.0), pose(f));
      for (int side = 0; side < 2; ++side) {
        to_.evaluate(pose(f));
        to_.bendLeg(side, ankles[side][f], pose(f));
      }
    }
  }

  const SkeletalMotion& source_;
  const CompletedSkeleton& completed_;
  bool knowsFeet_ = true;
  HumanRig from_;
  HumanRig to_;
  SkeletalRetargetSettings settings_;
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
                                      const SkeletalRetargetSettings& settings) {
  LORICA_TRY_DO(checkFrames(source));
  if (MirroredAxes(source.skeleton).any()) return retargetMotion(straightened(source), target, settings);
  const std::string named = "the motion " + source.name;
  LORICA_TRY(const CompletedSkeleton completed, prefixed(named, CompletedSkeleton::create(source.skeleton)));
  LORICA_TRY(HumanRig from, prefixed(named, HumanRig::create(completed.skeleton())));
  LORICA_TRY(HumanRig to, prefixed("the character", HumanRig::create(target)));
  if (completed.isWhole()) return SkeletalRetargeter(source, completed, std::move(from), std::move(to), settings).run();
  return SkeletalRetargeter(completed.complete(source), completed, std::move(from), std::move(to), settings).run();
}

Result<SkeletalMotion> retargetMotion(const SkeletalMotion& source, const Character& target,
                                      const SkeletalRetargetSettings& settings) {
  LORICA_TRY(ProxySkeleton proxy, ProxySkeleton::create(target));
  LORICA_TRY(SkeletalMotion performed, retargetMotion(source, proxy.skeleton(), settings));
  return proxy.mapBack(std::move(performed));
}

Result<std::vector<HumanBone>> bonesLeftAtRest(const Skeleton& source) {
  LORICA_TRY(const CompletedSkeleton completed, CompletedSkeleton::create(source));
  std::vector<HumanBone> bones;
  for (int b = 0; b < kHumanBoneCount; ++b) {
    if (!completed.speaksOf(static_cast<HumanBone>(b))) bones.push_back(static_cast<HumanBone>(b));
  }
  return bones;
}

}  // namespace lorica
