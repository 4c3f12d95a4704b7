#include "session/prepare/cover_choice.h"

#include "capture/retarget/proxy_skeleton.h"
#include "collision/live/choose_cover.h"
#include "collision/live/lifted_point.h"
#include "geometry/convex_hull.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "skinning/humanoid/joint_limits.h"
#include "skinning/linear_blend.h"

#include <fmt/format.h>

#include <algorithm>

namespace lorica {
namespace {

// In heights of the character. A smaller tolerance would select most points one by one, in half a minute or more.
constexpr double kLargestTolerance = 0.1;
constexpr double kSmallestTolerance = 1e-4;

constexpr int kVolumeStride = 4;  // 32 of 128 poses give the same mean, four times faster

}  // namespace

Result<void> checkCover(const CoverRequest& request, const Character& character) {
  if (request.tolerance && *request.tolerance == 0.0 && request.hullVertices > 0) {
    return invalidArgument("--cover exact and --hull-vertices {} exclude each other, expected only one of them",
                           request.hullVertices);
  }
  const double max = kLargestTolerance * character.height;
  const double min = kSmallestTolerance * character.height;
  if (request.tolerance && *request.tolerance > 0.0 && *request.tolerance < min) {
    return invalidArgument("--cover: found {:g} m, expected exact, or at least {:.2g} m (0.01 % of the height of {})",
                           *request.tolerance, min, character.name);
  }
  if (request.tolerance && *request.tolerance > max) {
    return invalidArgument("--cover: found {:g} m, expected at most {:.3g} m (10 % of the height of {})",
                           *request.tolerance, max, character.name);
  }
  return {};
}

std::string asTyped(const CoverRequest& request) {
  std::string text;
  if (request.tolerance) text = fmt::format("--cover {:g}", *request.tolerance);
  if (request.hullVertices > 0) {
    text += fmt::format("{}--hull-vertices {}", text.empty() ? "" : " ", request.hullVertices);
  }
  return text;
}

Result<HullCover> chooseCover(const Character& character, const Decomposition& decomposition, const CoverPoses& poses,
                              const CoverRequest& request, Host& host) {
  Task task(host, "Choosing a hull cover for " + character.name, "parts");
  task.update(0, countOf(decomposition.parts));
  CoverSettings settings;
  settings.tolerance = request.tolerance.value_or(0.0);
  settings.maxHullVertices = request.hullVertices;
  settings.threads = host.threads;
  settings.progress = task.progress();
  Result<HullCover> cover = chooseCover(decomposition, liftPoints(character, decomposition), poses.sampledView(),
                                        poses.heldOutView(), settings);
  if (host.cancelled()) return cancelled();
  if (!cover && cover.error().code == ErrorCode::kInvalidArgument) {
    return invalidArgument(asTyped(request) + ": " + cover.error().message);
  }
  return cover;
}

double volumeGrowth(const Character& character, const Decomposition& decomposition, const CoverPoses& poses,
                    const HullCover& cover) {
  const std::vector<LiftedPoint> lifted = liftPoints(character, decomposition);
  const HullCover exact = coverExactly(decomposition, lifted);
  const auto volume = [&](const HullCover& chosen, std::span<const Affine3> worldFromModel) {
    double sum = 0.0;
    for (const std::vector<CoverPoint>& points : chosen.points) {
      std::vector<Vec3> positions;
      positions.reserve(points.size());
      for (const CoverPoint& p : points) {
        positions.push_back(positionOf(pushed(lifted[p.point], p.outward), worldFromModel));
      }
      sum += convexHullVolume(positions);
    }
    return sum;
  };
  const BonePoseView view = poses.sampledView();
  double before = 0.0;
  double after = 0.0;
  for (int p = 0; p < view.poseCount(); p += kVolumeStride) {
    before += volume(exact, view.pose(p));
    after += volume(cover, view.pose(p));
  }
  return before > 0.0 ? after / before - 1.0 : 0.0;
}

namespace {

constexpr std::uint64_t kSampledSeed = 20180801;
constexpr std::uint64_t kHeldOutSeed = 20180802;
constexpr double kAtRest = 1e-6;  // sine of half the angle by which a bone's rest axes may differ from the model's

/// Whether human joint limits apply to this skeleton: each human bone and all its ancestors have no rest rotation.
bool hasKnownLimits(const Skeleton& skeleton) {
  for (const Joint& joint : skeleton.joints()) {
    const Joint* above = joint.bone ? &joint : nullptr;
    while (above != nullptr) {
      if (above->rest.rotation.vec().norm() > kAtRest) return false;
      above = above->parent == kNoJoint ? nullptr : &skeleton.joint(above->parent);
    }
  }
  return true;
}

/// Appends the transforms of a pose relative to the bind pose.
void append(const Character& character, std::span<const JointTransform> pose, std::vector<Affine3>& worldFromModel) {
  const std::size_t jointCount = character.skeleton.jointCount();
  worldFromModel.resize(worldFromModel.size() + jointCount);
  const std::span<Affine3> last = std::span(worldFromModel).last(jointCount);
  computeWorldFromJoint(character.skeleton, pose, last);
  computeWorldFromModel(character, last, last);
}

void appendRandom(const Character& character, ProxySkeleton& proxy, int count, std::uint64_t seed,
                  std::vector<Affine3>& worldFromModel) {
  RandomNumbers random(seed);
  Pose pose = restPose(character.skeleton);
  for (int i = 0; i < count; ++i) {
    proxy.mapBack(randomPoseWithinLimits(proxy.skeleton(), random), pose);
    append(character, pose, worldFromModel);
  }
}

}  // namespace

Result<CoverPoses> coverPoses(const Character& character, std::span<const SkeletalMotion> motions, int count) {
  LORICA_CHECK(count >= 2, "at least two poses are needed");
  std::size_t frameCount = 0;
  for (const SkeletalMotion& motion : motions) frameCount += motion.times.size();
  Result<ProxySkeleton> proxy = ProxySkeleton::create(character);
  const bool random = proxy && hasKnownLimits(proxy->skeleton());
  if (frameCount == 0 && !random) {
    return invalidArgument(
        "'{}': there are no motions, and the character is not a humanoid whose bones rest along the model's axes; "
        "expected one of the two as a source of poses",
        character.name);
  }

  CoverPoses poses;
  poses.jointCount = character.skeleton.jointCount();
  poses.randomPoses = !random ? 0 : frameCount == 0 ? count : count / 2;
  const auto each = static_cast<std::size_t>(poses.jointCount) * count;
  poses.sampled.reserve(each);
  poses.heldOut.reserve(each);

  // Frame round(i (frameCount - 1) / (wanted - 1)) for each i: sampled if i is even, held out if it is odd.
  const std::size_t wanted = std::min(2 * static_cast<std::size_t>(count - poses.randomPoses), frameCount);
  const std::size_t steps = std::max<std::size_t>(wanted, 2) - 1;
  const auto frameOf = [&](std::size_t i) { return (2 * i * (frameCount - 1) + steps) / (2 * steps); };
  std::size_t next = 0;
  std::size_t frame = 0;
  for (const SkeletalMotion& motion : motions) {
    for (int f = 0; f < motion.frameCount() && next < wanted; ++f, ++frame) {
      if (frame != frameOf(next)) continue;
      append(character, motion.pose(f), next % 2 == 0 ? poses.sampled : poses.heldOut);
      ++next;
    }
  }

  if (random) {
    appendRandom(character, *proxy, poses.randomPoses, kSampledSeed, poses.sampled);
    appendRandom(character, *proxy, poses.randomPoses, kHeldOutSeed, poses.heldOut);
  }
  return poses;
}

}  // namespace lorica
