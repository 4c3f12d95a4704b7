#include "session/keyframes.h"

#include "capture/retarget.h"
#include "geometry/rigid_distance.h"
#include "skinning/linear_blend.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace lorica {
namespace {

/// Poses one character by frames in their order; remembers what a retargeter remembers between them.
class Poser {
 public:
  Poser(const Character& character, Retargeter retargeter)
      : character_(character),
        retargeter_(std::move(retargeter)),
        pose_(restPose(character.skeleton)),
        worldFromJoint_(static_cast<std::size_t>(character.skeleton.jointCount())) {}

  void follow(const SkeletonFrame& frame) { retargeter_.apply(frame, pose_); }

  void skin(std::span<Vec3> posed) {
    computeWorldFromJoint(character_.skeleton, pose_, worldFromJoint_);
    computeWorldFromModel(character_, worldFromJoint_, worldFromJoint_);
    skinLinearBlend(character_, worldFromJoint_, posed);
  }

 private:
  const Character& character_;
  Retargeter retargeter_;
  Pose pose_;
  std::vector<Affine3> worldFromJoint_;
};

std::size_t frameCountOf(std::span<const std::vector<SkeletonFrame>> recordings) {
  std::size_t count = 0;
  for (const std::vector<SkeletonFrame>& recording : recordings) count += recording.size();
  return count;
}

/// Poses a character by some frames of recordings, counted as if these were laid end to end.
/// @param frames  ascending
/// @return positions [m], as many as frames times vertexCount, frame-major
Result<std::vector<Vec3>> poseFrames(const Character& character, std::span<const std::vector<SkeletonFrame>> recordings,
                                     std::span<const std::size_t> frames) {
  const std::size_t vertexCount = character.mesh.vertices.size();
  std::vector<Vec3> positions(frames.size() * vertexCount);
  std::size_t next = 0;
  std::size_t frame = 0;
  for (const std::vector<SkeletonFrame>& recording : recordings) {
    // Each recording is another performance: nothing is held over from the one before.
    Result<Retargeter> retargeter = Retargeter::create(character.skeleton);
    if (!retargeter) return retargeter.error();
    Poser poser(character, std::move(retargeter).value());
    for (std::size_t f = 0; f < recording.size(); ++f, ++frame) {
      poser.follow(recording[f]);
      if (next == frames.size() || frames[next] != frame) continue;
      poser.skin(std::span(positions).subspan(next * vertexCount, vertexCount));
      ++next;
    }
  }
  return positions;
}

constexpr std::size_t kVerticesCompared = 300;
constexpr std::size_t kFramesCompared = 10000;

/// round(k (from - 1) / (count - 1)) in whole numbers for each k: `count` of `from` things, the first and last
/// included.
std::vector<std::size_t> evenly(std::size_t count, std::size_t from) {
  std::vector<std::size_t> chosen(count);
  const std::size_t steps = std::max<std::size_t>(count - 1, 1);
  for (std::size_t k = 0; k < count; ++k) chosen[k] = (2 * k * (from - 1) + steps) / (2 * steps);
  return chosen;
}

/// The character with some of its vertices and no triangles: enough to compare poses by.
Character withFewerVertices(const Character& character) {
  const std::size_t all = character.mesh.vertices.size();
  Character few = character;
  few.mesh = {};
  few.influences.clear();
  few.influenceBegin.assign(1, 0);
  for (const std::size_t v : evenly(std::min(all, kVerticesCompared), all)) {
    few.mesh.vertices.push_back(character.mesh.vertices[v]);
    const auto begin = character.influences.begin();
    few.influences.insert(few.influences.end(), begin + character.influenceBegin[v],
                          begin + character.influenceBegin[v + 1]);
    few.influenceBegin.push_back(static_cast<std::uint32_t>(few.influences.size()));
  }
  return few;
}

}  // namespace

Result<std::vector<Vec3>> poseAllFrames(const Character& character, std::span<const SkeletonFrame> recording) {
  Result<Retargeter> retargeter = Retargeter::create(character.skeleton);
  if (!retargeter) return retargeter.error();
  Poser poser(character, std::move(retargeter).value());

  const std::size_t vertexCount = character.mesh.vertices.size();
  std::vector<Vec3> positions(recording.size() * vertexCount);
  for (std::size_t f = 0; f < recording.size(); ++f) {
    poser.follow(recording[f]);
    poser.skin(std::span(positions).subspan(f * vertexCount, vertexCount));
  }
  return positions;
}

Result<std::vector<Vec3>> sampleKeyframes(const Character& character,
                                          std::span<const std::vector<SkeletonFrame>> recordings, int count) {
  const std::size_t frameCount = frameCountOf(recordings);
  if (count < 1)
    return Error{ErrorCode::kInvalidArgument, fmt::format("{} keyframes asked for, expected 1 or more", count)};
  const auto wanted = static_cast<std::size_t>(count);
  if (wanted > frameCount) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{} keyframes asked for, the recordings have {} frames", count, frameCount)};
  }
  return poseFrames(character, recordings, evenly(wanted, frameCount));
}

Result<ChosenKeyframes> chooseKeyframes(const Character& character,
                                        std::span<const std::vector<SkeletonFrame>> recordings, int atMost,
                                        double closeEnough) {
  const std::size_t frameCount = frameCountOf(recordings);
  if (atMost < 1) {
    return Error{ErrorCode::kInvalidArgument, fmt::format("{} keyframes asked for, expected 1 or more", atMost)};
  }
  if (frameCount == 0) return Error{ErrorCode::kInvalidArgument, "the recordings have no frames to choose from"};

  // All poses, small and about their centroids.
  const Character few = withFewerVertices(character);
  const std::vector<std::size_t> looked = evenly(std::min(frameCount, kFramesCompared), frameCount);
  Result<std::vector<Vec3>> posed = poseFrames(few, recordings, looked);
  if (!posed) return posed.error();
  const std::size_t size = few.mesh.vertices.size();
  const auto pose = [&](std::size_t i) { return std::span(*posed).subspan(i * size, size); };
  for (std::size_t i = 0; i < looked.size(); ++i) {
    Vec3 centroid = Vec3::Zero();
    for (const Vec3& p : pose(i)) centroid += p / static_cast<double>(size);
    for (Vec3& p : pose(i)) p -= centroid;
  }

  // Farthest first (Gonzalez 1985); of several as far, the earliest.
  ChosenKeyframes result;
  std::vector<std::size_t> chosen;
  std::vector<double> nearest(looked.size(), std::numeric_limits<double>::infinity());
  std::size_t next = 0;
  while (true) {
    chosen.push_back(looked[next]);
    for (std::size_t i = 0; i < looked.size(); ++i) {
      nearest[i] = std::min(nearest[i], rigidDistance(pose(next), pose(i)));
    }
    next = static_cast<std::size_t>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
    result.farthest = nearest[next];
    if (result.farthest <= closeEnough || chosen.size() == static_cast<std::size_t>(atMost)) break;
  }
  std::sort(chosen.begin(), chosen.end());

  Result<std::vector<Vec3>> positions = poseFrames(character, recordings, chosen);
  if (!positions) return positions.error();
  result.positions = std::move(*positions);
  std::size_t first = 0;  // frame of the recording, counted as if all were laid end to end
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    for (const std::size_t frame : chosen) {
      if (frame < first || frame >= first + recordings[r].size()) continue;
      result.sources.push_back({r, frame - first, recordings[r][frame - first].time});
    }
    first += recordings[r].size();
  }
  return result;
}

}  // namespace lorica
