#include "session/keyframes.h"

#include "capture/retarget.h"
#include "skinning/linear_blend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

/// Poses one character by frames in their order; remembers what a retargeter remembers between them.
class Poser {
 public:
  Poser(const Character& character, Retargeter retargeter)
      : character_(character),
        retargeter_(std::move(retargeter)),
        pose_(restPose(character.skeleton)),
        worldFromJoint_(static_cast<std::size_t>(character.skeleton.jointCount())),
        skinMatrices_(worldFromJoint_.size()) {}

  void follow(const SkeletonFrame& frame) { retargeter_.apply(frame, pose_); }

  void skin(std::span<Vec3> posed) {
    computeWorldFromJoint(character_.skeleton, pose_, worldFromJoint_);
    skinLinearBlend(character_, worldFromJoint_, skinMatrices_, posed);
  }

 private:
  const Character& character_;
  Retargeter retargeter_;
  Pose pose_;
  std::vector<Affine3> worldFromJoint_, skinMatrices_;
};

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
  std::size_t frameCount = 0;
  for (const std::vector<SkeletonFrame>& recording : recordings) frameCount += recording.size();
  if (count < 1)
    return Error{ErrorCode::kInvalidArgument, fmt::format("{} keyframes asked for, expected 1 or more", count)};
  const auto wanted = static_cast<std::size_t>(count);
  if (wanted > frameCount) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{} keyframes asked for, the recordings have {} frames", count, frameCount)};
  }

  std::vector<std::size_t> chosen;  // of the recordings laid end to end
  for (std::size_t k = 0; k < wanted; ++k) {
    // round(k (N - 1) / (K - 1)) in whole numbers; a single keyframe is the first frame.
    const std::size_t steps = std::max<std::size_t>(wanted - 1, 1);
    chosen.push_back((2 * k * (frameCount - 1) + steps) / (2 * steps));
  }

  const std::size_t vertexCount = character.mesh.vertices.size();
  std::vector<Vec3> positions(wanted * vertexCount);
  std::size_t next = 0;
  std::size_t frame = 0;
  for (const std::vector<SkeletonFrame>& recording : recordings) {
    // Each recording is another performance: nothing is held over from the one before.
    Result<Retargeter> retargeter = Retargeter::create(character.skeleton);
    if (!retargeter) return retargeter.error();
    Poser poser(character, std::move(retargeter).value());
    for (std::size_t f = 0; f < recording.size(); ++f, ++frame) {
      poser.follow(recording[f]);
      if (next == wanted || chosen[next] != frame) continue;
      poser.skin(std::span(positions).subspan(next * vertexCount, vertexCount));
      ++next;
    }
  }
  return positions;
}

}  // namespace lorica
