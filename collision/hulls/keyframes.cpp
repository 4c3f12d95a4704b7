#include "collision/hulls/keyframes.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/rigid_distance.h"
#include "geometry/text.h"
#include "skinning/linear_blend.h"

#include <algorithm>
#include <limits>

namespace lorica {
namespace {

/// Skins one character in a series of poses.
class Poser {
 public:
  explicit Poser(const Character& character)
      : character_(character), worldFromModel_(character.skeleton.jointCount()) {}

  void skin(std::span<const JointTransform> pose, std::span<Vec3> posed) {
    computeWorldFromJoint(character_.skeleton, pose, worldFromModel_);
    computeWorldFromModel(character_, worldFromModel_, worldFromModel_);
    skinLinearBlend(character_, worldFromModel_, posed);
  }

 private:
  const Character& character_;
  std::vector<Affine3> worldFromModel_;
};

std::size_t frameCountOf(std::span<const SkeletalMotion> motions) {
  std::size_t count = 0;
  for (const SkeletalMotion& motion : motions) count += motion.times.size();
  return count;
}

/// Visits some frames of motions: visit(position in `frames`, motion, frame of that motion).
/// @param frames  indices in the concatenated motions, ascending
template <typename Visit>
void forFrames(std::span<const SkeletalMotion> motions, std::span<const std::size_t> frames, const Visit& visit) {
  std::size_t next = 0;
  std::size_t first = 0;  // index of the motion's first frame in the concatenated motions
  for (std::size_t m = 0; m < motions.size(); ++m) {
    const std::size_t end = first + motions[m].times.size();
    for (; next < frames.size() && frames[next] < end; ++next) visit(next, m, frames[next] - first);
    first = end;
  }
}

/// Poses a character in some frames of motions, see forFrames().
/// @return positions [m], as many as frames times vertexCount, frame-major
std::vector<Vec3> poseFrames(const Character& character, std::span<const SkeletalMotion> motions,
                             std::span<const std::size_t> frames) {
  const std::size_t vertexCount = character.mesh.vertices.size();
  std::vector<Vec3> positions(frames.size() * vertexCount);
  Poser poser(character);
  forFrames(motions, frames, [&](std::size_t k, std::size_t m, std::size_t frame) {
    poser.skin(motions[m].pose(frame), std::span(positions).subspan(k * vertexCount, vertexCount));
  });
  return positions;
}

/// The bones in some frames of motions, see forFrames().
/// @return worldFromModel, as many poses as frames x jointCount, pose-major
std::vector<Affine3> bonesInFrames(const Character& character, std::span<const SkeletalMotion> motions,
                                   std::span<const std::size_t> frames) {
  const std::size_t jointCount = character.skeleton.jointCount();
  std::vector<Affine3> bones(frames.size() * jointCount);
  forFrames(motions, frames, [&](std::size_t k, std::size_t m, std::size_t frame) {
    const std::span<Affine3> here = std::span(bones).subspan(k * jointCount, jointCount);
    computeWorldFromJoint(character.skeleton, motions[m].pose(frame), here);
    computeWorldFromModel(character, here, here);
  });
  return bones;
}

constexpr std::size_t kVerticesCompared = 300;
constexpr std::size_t kFramesCompared = 10000;

/// `count` of `from` indices at even intervals, including the first and the last: round(k (from - 1) / (count - 1)) in
/// integer arithmetic for each k.
std::vector<std::size_t> evenly(std::size_t count, std::size_t from) {
  std::vector<std::size_t> chosen(count);
  const std::size_t steps = std::max<std::size_t>(count - 1, 1);
  for (std::size_t k = 0; k < count; ++k) chosen[k] = (2 * k * (from - 1) + steps) / (2 * steps);
  return chosen;
}

/// The character with fewer vertices and no triangles, for comparing poses.
Character withFewerVertices(const Character& character) {
  const std::size_t all = character.mesh.vertices.size();
  Character few = character;
  few.mesh = {};
  few.influences.clear();
  few.influenceBegin.assign(1, 0);
  few.shapes = {};
  for (const std::size_t v : evenly(std::min(all, kVerticesCompared), all)) {
    few.mesh.vertices.push_back(character.mesh.vertices[v]);
    const auto begin = character.influences.begin();
    few.influences.insert(few.influences.end(), begin + character.influenceBegin[v],
                          begin + character.influenceBegin[v + 1]);
    few.influenceBegin.push_back(few.influences.size());
    few.shapes.append(character.shapes.of(v));
  }
  return few;
}

/// Farthest-first traversal (Gonzalez 1985) of poses, from the first; the earliest one wins ties.
/// @param posed     poses x size, pose-major; changed
/// @param farthest  written, see ChosenKeyframes
/// @return indices of the chosen poses, ascending
std::vector<std::size_t> mostDifferent(std::vector<Vec3> posed, std::size_t size, int atMost, double closeEnough,
                                       double& farthest) {
  const std::size_t count = posed.size() / size;
  const auto pose = [&](std::size_t i) { return std::span(posed).subspan(i * size, size); };
  for (std::size_t i = 0; i < count; ++i) {  // relative to their centroids
    Vec3 centroid = Vec3::Zero();
    for (const Vec3& p : pose(i)) centroid += p / size;
    for (Vec3& p : pose(i)) p -= centroid;
  }
  std::vector<std::size_t> chosen;
  std::vector<double> nearest(count, std::numeric_limits<double>::infinity());
  std::size_t next = 0;
  while (true) {
    chosen.push_back(next);
    for (std::size_t i = 0; i < count; ++i) nearest[i] = std::min(nearest[i], rigidDistance(pose(next), pose(i)));
    next = std::max_element(nearest.begin(), nearest.end()) - nearest.begin();
    farthest = nearest[next];
    if (farthest <= closeEnough || countOf(chosen) == atMost) break;
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace

std::vector<Vec3> poseAllFrames(const Character& character, const SkeletalMotion& motion) {
  const std::size_t vertexCount = character.mesh.vertices.size();
  std::vector<Vec3> positions(motion.times.size() * vertexCount);
  Poser poser(character);
  for (int f = 0; f < motion.frameCount(); ++f) {
    poser.skin(motion.pose(f), std::span(positions).subspan(f * vertexCount, vertexCount));
  }
  return positions;
}

Result<std::vector<Vec3>> sampleKeyframes(const Character& character, std::span<const SkeletalMotion> motions,
                                          int count) {
  const std::size_t frameCount = frameCountOf(motions);
  if (count < 1) return invalidArgument("{} keyframes requested, expected 1 or more", count);
  const std::size_t wanted = count;
  if (wanted > frameCount) {
    return invalidArgument("{} requested, the motions have {}", counted(count, "keyframe"),
                           counted(std::int64_t(frameCount), "frame"));
  }
  return poseFrames(character, motions, evenly(wanted, frameCount));
}

std::vector<Affine3> sampleBones(const Character& character, std::span<const SkeletalMotion> motions, int count) {
  return bonesInFrames(character, motions, evenly(count, frameCountOf(motions)));
}

Result<ChosenKeyframes> chooseKeyframes(const Character& character, std::span<const SkeletalMotion> motions, int atMost,
                                        double closeEnough) {
  const std::size_t frameCount = frameCountOf(motions);
  if (atMost < 1) {
    return invalidArgument("{} keyframes requested, expected 1 or more", atMost);
  }
  if (frameCount == 0) return invalidArgument("the motions have no frames to choose from");

  const Character few = withFewerVertices(character);
  const std::vector<std::size_t> looked = evenly(std::min(frameCount, kFramesCompared), frameCount);
  ChosenKeyframes result;
  std::vector<std::size_t> chosen =
      mostDifferent(poseFrames(few, motions, looked), few.mesh.vertices.size(), atMost, closeEnough, result.farthest);
  for (std::size_t& frame : chosen) frame = looked[frame];
  result.positions = poseFrames(character, motions, chosen);
  result.worldFromModel = bonesInFrames(character, motions, chosen);
  result.sources.reserve(chosen.size());
  forFrames(motions, chosen, [&](std::size_t /*k*/, std::size_t m, std::size_t frame) {
    result.sources.push_back({m, frame, motions[m].times[frame]});
  });
  return result;
}

ChosenKeyframes chooseAmongPoses(const Character& character, std::span<const Affine3> worldFromModel, int atMost,
                                 double closeEnough) {
  const std::size_t jointCount = character.skeleton.jointCount();
  const std::size_t count = worldFromModel.size() / jointCount;
  LORICA_CHECK(count > 0 && atMost > 0, "there must be a pose, and one to be chosen");
  const auto skinned = [&](const Character& some, std::span<const std::size_t> poses) {
    const std::size_t size = some.mesh.vertices.size();
    std::vector<Vec3> posed(poses.size() * size);
    for (std::size_t k = 0; k < poses.size(); ++k) {
      skinLinearBlend(some, worldFromModel.subspan(poses[k] * jointCount, jointCount),
                      std::span(posed).subspan(k * size, size));
    }
    return posed;
  };
  const Character few = withFewerVertices(character);
  const std::vector<std::size_t> looked = evenly(std::min(count, kFramesCompared), count);
  ChosenKeyframes result;
  std::vector<std::size_t> chosen =
      mostDifferent(skinned(few, looked), few.mesh.vertices.size(), atMost, closeEnough, result.farthest);
  for (std::size_t& pose : chosen) {
    pose = looked[pose];
    result.sources.push_back({0, pose, 0.0});
    const std::span<const Affine3> bones = worldFromModel.subspan(pose * jointCount, jointCount);
    result.worldFromModel.insert(result.worldFromModel.end(), bones.begin(), bones.end());
  }
  result.positions = skinned(character, chosen);
  return result;
}

}  // namespace lorica
