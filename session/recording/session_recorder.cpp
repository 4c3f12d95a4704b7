#include "session/recording/session_recorder.h"

#include "geometry/descriptor.h"
#include "geometry/errors.h"
#include "geometry/new_file.h"
#include "session/recording/session_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kRoomForTheEnd = 64;  // of the last block [bytes]

Error cannotWrite(const fs::path& file, int error) {
  return unwritable("{}: {}", file.string(), std::generic_category().message(error));
}

void put(const Vec3& v, ByteWriter& bytes) {
  for (int i = 0; i < 3; ++i) bytes.put(v[i]);
}

void put(const Quat& q, ByteWriter& bytes) {
  for (int i = 0; i < 4; ++i) bytes.put(q.coeffs()[i]);
}

void put(const SkeletonFrame& frame, ByteWriter& bytes) {
  bytes.put(frame.time);
  bytes.put(static_cast<std::int32_t>(frame.user));
  for (const TrackedJoint& joint : frame.joints) {
    bytes.put(static_cast<std::uint8_t>(joint.orientation ? 1 : 0));
    bytes.put(joint.confidence);
    put(joint.position, bytes);
    if (joint.orientation) put(*joint.orientation, bytes);
  }
}

void put(const WorldAction& action, ByteWriter& bytes) {
  bytes.put(static_cast<std::uint8_t>(action.kind));
  bytes.put(static_cast<std::uint8_t>(action.hand));
  bytes.put(static_cast<std::int32_t>(action.prop));
  put(action.position, bytes);
  put(action.velocity, bytes);
  bytes.put(action.radius);
}

}  // namespace

Result<std::shared_ptr<SessionRecorder>> SessionRecorder::start(const fs::path& file, const SessionHeader& header,
                                                                std::string_view sceneText, std::uint64_t maxBytes) {
  if (sceneText.size() > kLargestBlock) {
    return invalidArgument("{}: a scene of {} bytes, expected at most {}", file.string(), sceneText.size(),
                           kLargestBlock);
  }
  const fs::path part = fs::path(file).replace_extension(".part.lsession");
  LORICA_TRY(std::optional<fs::path> found, keepFound(part));
  LORICA_TRY(const int descriptor, createPart(part));
  std::shared_ptr<SessionRecorder> recorder(new SessionRecorder(file, part, descriptor, header, maxBytes));
  recorder->found_ = std::move(found);
  recorder->block_ = kSessionMagic;
  appendBlock(BlockKind::kHeader, textOf(header), recorder->chain_, recorder->block_);
  appendBlock(BlockKind::kScene, sceneText, recorder->chain_, recorder->block_);
  LORICA_TRY_DO(recorder->write());
  return recorder;
}

SessionRecorder::SessionRecorder(fs::path file, fs::path part, int descriptor, const SessionHeader& header,
                                 std::uint64_t maxBytes)
    : file_(std::move(file)), part_(std::move(part)), descriptor_(descriptor), maxBytes_(maxBytes) {
  tracks_.reserve(header.avatars.size());
  for (const AvatarRecord& avatar : header.avatars) tracks_.push_back({avatar.poseJoints > 0, avatar.poseExpressions});
}

SessionRecorder::~SessionRecorder() {
  if (descriptor_ >= 0) close(descriptor_);
}

Result<void> SessionRecorder::write() {
  if (const int error = writeAll(descriptor_, block_, &bytes_); error != 0) return cannotWrite(part_, error);
  block_.clear();
  return {};
}

void SessionRecorder::clearLogs() {
  for (const Track& track : tracks_) track.log->clear();
}

Result<void> SessionRecorder::afterStep(const Session& session, std::span<const WorldAction> done) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (over_ || full_ || descriptor_ < 0) {
    clearLogs();
    return {};
  }
  const SessionHashes& hashes = session.hashes();
  step_.clear();
  step_.put(session.time());
  step_.put(hashes.hulls);
  step_.put(hashes.props);
  step_.put(hashes.particles);
  step_.put(static_cast<std::uint32_t>(done.size()));
  for (const Track& track : tracks_) putMotion(track);
  for (const WorldAction& action : done) put(action, step_);
  clearLogs();
  const std::uint64_t chain = chain_;
  appendBlock(BlockKind::kStep, step_.bytes(), chain_, block_);
  if (bytes_ + block_.size() + kRoomForTheEnd > maxBytes_) {
    full_ = true;
    chain_ = chain;
    block_.clear();
    return {};
  }
  ++steps_;
  return write();
}

/// Adds what the source of an avatar gave in a step.
void SessionRecorder::putMotion(const Track& track) {
  const SourceLog& log = *track.log;
  step_.put(static_cast<std::uint32_t>(track.poses ? log.poseTimes.size() : log.joints.size()));
  if (!track.poses) {
    for (const SkeletonFrame& frame : log.joints) put(frame, step_);
    return;
  }
  const std::size_t joints = log.poseTimes.empty() ? 0 : log.poses.size() / log.poseTimes.size();
  for (std::size_t i = 0; i < log.poseTimes.size(); ++i) {
    step_.put(log.poseTimes[i]);
    for (const JointTransform& joint : std::span(log.poses).subspan(i * joints, joints)) {
      put(joint.translation, step_);
      put(joint.rotation, step_);
      put(joint.scale, step_);
    }
    if (log.trust.empty()) continue;
    for (const double trust : std::span(log.trust).subspan(i * joints, joints)) step_.put(trust);
  }
  if (track.expressions) step_.put(log.expressions.bytes());
}

Result<int> SessionRecorder::finish() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (descriptor_ < 0) return steps_;
  std::error_code ignored;
  if (steps_ == 0) {
    close(std::exchange(descriptor_, -1));
    fs::remove(part_, ignored);
    return 0;
  }
  appendBlock(BlockKind::kEnd, "", chain_, block_);
  LORICA_TRY_DO(write());
  const bool kept = fsync(descriptor_) == 0 || errno == EINVAL;  // EINVAL: pipes and devices do not support fsync
  const int error = errno;
  close(std::exchange(descriptor_, -1));
  if (!kept) return cannotWrite(part_, error);
  std::error_code renamed;
  fs::rename(part_, file_, renamed);
  if (renamed) return cannotWrite(file_, renamed.value());
  return steps_;
}

}  // namespace lorica
