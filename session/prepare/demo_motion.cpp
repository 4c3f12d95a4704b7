#include "session/prepare/demo_motion.h"

#include "session/scenes/demo_scene.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lorica {
namespace {

constexpr double kRate = 30.0;  // of the shipped recordings [1/s]
constexpr double kFadeSeconds = 0.4;
constexpr double kUsualHeight = 1.75;  // of the person whom the boxes and balls suit [m]

struct Piece {
  const char* recording;
  double from;  // [s]
  double to;
};

/// A kick that knocks over the tower in front while objects fall, then a walk through the rubble.
constexpr Piece kPieces[] = {
    {"punch_and_kick", 5.6, 7.5},
    {"walk", 0.9, 10.6},
};

/// The midpoint between the feet, on the floor.
Vec3 footing(const SkeletonFrame& frame) {
  Vec3 middle = 0.5 * (frame[BodyJoint::kLeftFoot].position + frame[BodyJoint::kRightFoot].position);
  middle.y() = 0.0;
  return middle;
}

void moveBy(const Vec3& offset, std::vector<SkeletonFrame>& frames) {
  for (SkeletonFrame& frame : frames) {
    for (TrackedJoint& joint : frame.joints) joint.position += offset;
  }
}

/// Interpolates from a to b; `share` is between 0 and 1.
SkeletonFrame blend(const SkeletonFrame& a, const SkeletonFrame& b, double share) {
  SkeletonFrame mixed = a;
  for (int j = 0; j < kBodyJointCount; ++j) {
    TrackedJoint& joint = mixed.joints[j];
    const TrackedJoint& other = b.joints[j];
    joint.position += share * (other.position - joint.position);
    joint.confidence = std::min(joint.confidence, other.confidence);
    if (joint.orientation && other.orientation) {
      joint.orientation = joint.orientation->slerp(share, *other.orientation);
    } else {
      joint.orientation.reset();
    }
  }
  return mixed;
}

/// Appends a piece; its first frames are cross-faded with the last existing frames.
void append(std::vector<SkeletonFrame>& frames, std::vector<SkeletonFrame> piece) {
  std::size_t overlap = 0;
  if (!frames.empty()) {
    const std::size_t wanted = std::lround(kFadeSeconds * kRate);
    overlap = std::min({wanted, frames.size(), piece.size()});
    moveBy(footing(frames.back()) - footing(piece.front()), piece);
  }
  const std::size_t first = frames.size() - overlap;
  for (std::size_t i = 0; i < overlap; ++i) {
    const double t = static_cast<double>(i + 1) / (overlap + 1);
    frames[first + i] = blend(frames[first + i], piece[i], t * t * (3.0 - 2.0 * t));
  }
  frames.insert(frames.end(), piece.begin() + overlap, piece.end());
}

}  // namespace

Result<Motion> makeDemoMotion(Host& host) {
  Motion performance;
  performance.name = "kick and walk";
  for (const Piece& piece : kPieces) {
    LORICA_TRY(const Motion recording, readMotion(piece.recording, {}, host));
    std::vector<SkeletonFrame> frames;
    const double start = recording.joints.front().time;
    for (const SkeletonFrame& frame : recording.joints) {
      const double time = frame.time - start;
      if (time >= piece.from && time <= piece.to) frames.push_back(frame);
    }
    append(performance.joints, std::move(frames));
  }
  for (std::size_t i = 0; i < performance.joints.size(); ++i) {
    performance.joints[i].time = i / kRate;
  }
  return performance;
}

Result<DemoCast> prepareDemo(const std::string& character, const std::string& scene, Host& host) {
  CastRequest request;
  request.reading.drawn = true;
  if (!scene.empty()) {
    request.scene = scene;
    CastRequest moved = request;
    moved.motion = kDemoCharacterMotion;
    const bool given = character != "mannequin";
    if (given) request.character = moved.character = character;
    LORICA_TRY(Cast cast, prepareSettledCast(given ? std::vector{moved, request} : std::vector{request, moved}, host));
    return DemoCast{std::move(cast), {}};
  }
  LORICA_TRY(Motion motion, makeDemoMotion(host));
  AvatarSetting setting;
  setting.character = character;
  Result<PreparedAvatar> avatar = readAvatar(request, setting, std::move(motion), host);
  if (!avatar && avatar.error().code == ErrorCode::kInvalidArgument) {  // no humanoid: its own clip, or it stands
    if (Result<PreparedAvatar> own = readAvatar(request, setting, {}, host)) avatar = std::move(own);
  }
  if (!avatar) return avatar.error();
  LORICA_TRY(CachedDecomposition body, defaultDecomposition(avatar->subject, host));
  avatar->springs = chooseSprings(avatar->subject, {});
  avatar->body = std::move(body.file);
  const double scale = character == "mannequin" ? 1.0 : avatar->character().height / kUsualHeight;
  Cast cast{std::move(request), makeDemoWorldUnder(World::Settings().gravity, kDemoSeed, scale)};
  cast.propScale = scale;
  cast.name = avatar->source;
  cast.seconds = avatar->motion->seconds();
  cast.avatars.push_back(std::move(*avatar));
  cast.sources = motionSources();
  return DemoCast{std::move(cast), body.fromCache, body.seconds};
}

}  // namespace lorica
