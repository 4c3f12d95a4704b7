#include "session/recording/session_file.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"

#include "geometry/byte_reader.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/interrupt.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace lorica {
namespace {

constexpr double kFarthest = 1e6;      ///< maximum of each recorded coordinate [m]
constexpr double kLongestTime = 1e12;  ///< [s]
constexpr double kUnitTolerance = 1e-3;

/// Reads one step, up to its first error.
class StepReader {
 public:
  /// @param taken  frames of the steps before; gets this step's too
  StepReader(std::string_view payload, const SessionHeader& header, SessionFile& file, std::size_t& taken)
      : reader_(payload), header_(header), file_(file), taken_(taken) {}

  /// @return the error; nothing if the step is valid
  std::optional<std::string> read() {
    SessionStep step;
    step.time = time();
    step.hashes.hulls = reader_.take<std::uint64_t>();
    step.hashes.props = reader_.take<std::uint64_t>();
    step.hashes.particles = reader_.take<std::uint64_t>();
    step.actions = reader_.take<std::uint32_t>();
    for (std::size_t a = 0; a < header_.avatars.size() && !wrong_ && reader_.ok(); ++a) {
      step.frames += readMotion(header_.avatars[a], file_.motions[a]);
    }
    if (!wrong_) checkRecords(step.actions);
    for (std::size_t i = 0; i < step.actions && !wrong_ && reader_.ok(); ++i) readAction();
    if (!reader_.ok()) return "is truncated";
    if (wrong_) return wrong_;
    if (reader_.left() > 0) return fmt::format("holds {} too many", counted(std::int64_t(reader_.left()), "byte"));
    // Every step shows a frame that some avatar took in it or before.
    taken_ += step.frames;
    if (taken_ <= file_.steps.size())
      return fmt::format("comes after the last of {}", counted(std::int64_t(taken_), "frame"));
    file_.steps.push_back(step);
    return std::nullopt;
  }

 private:
  void fail(std::string what) {
    if (!wrong_) wrong_ = std::move(what);
  }

  /// Rejects a number of records that cannot be there: each takes more than one byte.
  void checkRecords(std::size_t count) {
    if (reader_.left() < count) fail(fmt::format("holds {} bytes, expected {} records", reader_.left(), count));
  }

  /// @return the number of frames
  std::size_t readMotion(const AvatarRecord& avatar, RecordedMotion& motion) {
    const auto count = reader_.take<std::uint32_t>();
    checkRecords(count);
    const bool poses = avatar.poseJoints > 0;
    for (std::size_t i = 0; i < count && !wrong_ && reader_.ok(); ++i) {
      if (poses) {
        readPose(avatar, motion);
      } else {
        readJoints(motion);
      }
    }
    for (std::size_t i = 0; avatar.poseExpressions && i < count && !wrong_ && reader_.ok(); ++i) {
      readExpressions(motion);
    }
    return count;
  }

  double time() {
    const auto time = reader_.take<double>();
    if (!(std::abs(time) <= kLongestTime)) fail(fmt::format("found a time of {} s, expected a finite one", time));
    return time;
  }

  Vec3 vector() {
    Vec3 v;
    for (int i = 0; i < 3; ++i) v[i] = reader_.take<double>();
    return v;
  }

  Vec3 position(const char* of) {
    const Vec3 v = vector();
    if (!(v.allFinite() && v.cwiseAbs().maxCoeff() <= kFarthest)) {
      fail(fmt::format("found {} at ({}, {}, {}), expected it within {:g} m", of, v.x(), v.y(), v.z(), kFarthest));
    }
    return v;
  }

  Quat rotation() {
    Quat q;
    for (int i = 0; i < 4; ++i) q.coeffs()[i] = reader_.take<double>();
    if (!(std::abs(q.norm() - 1.0) <= kUnitTolerance)) {
      fail(fmt::format("found a quaternion of length {}, expected 1", q.norm()));
    }
    return q;
  }

  void readJoints(RecordedMotion& motion) {
    SkeletonFrame frame;
    frame.time = time();
    frame.user = reader_.take<std::int32_t>();
    for (TrackedJoint& joint : frame.joints) {
      const auto oriented = reader_.take<std::uint8_t>();
      if (oriented > 1) fail(fmt::format("found {} for the orientation flag of a joint, expected 0 or 1", oriented));
      joint.confidence = reader_.take<double>();
      if (!(joint.confidence >= 0.0 && joint.confidence <= 1.0)) {
        fail(fmt::format("found a confidence of {}, expected 0 to 1", joint.confidence));
      }
      joint.position = position("a joint");
      if (oriented == 1) joint.orientation = rotation();
    }
    motion.joints.push_back(frame);
  }

  void readPose(const AvatarRecord& avatar, RecordedMotion& motion) {
    motion.poseTimes.push_back(time());
    for (int j = 0; j < avatar.poseJoints && !wrong_ && reader_.ok(); ++j) {
      JointTransform joint;
      joint.translation = position("a joint");
      joint.rotation = rotation();
      joint.scale = position("a scale");
      motion.poses.push_back(joint);
    }
    if (!avatar.poseTrust) return;
    for (int j = 0; j < avatar.poseJoints && !wrong_ && reader_.ok(); ++j) {
      const auto trust = reader_.take<double>();
      if (!(trust >= 0.0 && trust <= 1.0)) fail(fmt::format("found a trust of {}, expected 0 to 1", trust));
      motion.poseTrust.push_back(trust);
    }
  }

  void readExpressions(RecordedMotion& motion) {
    std::vector<NamedWeight>& all = motion.poseExpressions.emplace_back();
    const auto count = reader_.take<std::uint16_t>();
    if (count > kMaxPoseExpressions) {
      return fail(fmt::format("found {} expressions, expected at most {}", count, kMaxPoseExpressions));
    }
    for (std::size_t i = 0; i < count && !wrong_ && reader_.ok(); ++i) {
      const auto length = reader_.take<std::uint8_t>();
      if (length > kMaxExpressionName) {
        return fail(fmt::format("found a name of {} bytes, expected at most {}", length, kMaxExpressionName));
      }
      NamedWeight one;
      one.name = reader_.takeText(length);
      one.weight = reader_.take<float>();
      if (!(one.weight >= 0.0f && one.weight <= 1.0f)) {
        fail(fmt::format("found an expression of weight {}, expected 0 to 1", one.weight));
      }
      all.push_back(std::move(one));
    }
  }

  void readAction() {
    WorldAction action;
    const auto kind = reader_.take<std::uint8_t>();
    if (kind >= kWorldActionKinds) fail(fmt::format("found an action of kind {}, expected 0 to 3", kind));
    action.kind = static_cast<WorldAction::Kind>(kind % kWorldActionKinds);
    action.hand = reader_.take<std::uint8_t>();
    if (action.hand >= World::kMaxHands) {
      fail(fmt::format("found hand {}, expected 0 to {}", action.hand, World::kMaxHands - 1));
    }
    action.prop = reader_.take<std::int32_t>();
    action.position = position("an action");
    action.velocity = position("a velocity");
    action.radius = reader_.take<double>();
    if (!(action.radius >= 0.0 && action.radius <= kLargestBall)) {
      fail(fmt::format("found a ball of radius {}, expected 0 to {:g} m", action.radius, kLargestBall));
    }
    file_.actions.push_back(action);
  }

  ByteReader reader_;
  const SessionHeader& header_;
  SessionFile& file_;
  std::size_t& taken_;
  std::optional<std::string> wrong_;
};

// Layout of a block: kind and length, their checksum, the payload, its checksum.
constexpr std::size_t kHeadBytes = 2 * sizeof(std::uint32_t);
constexpr std::size_t kCheckBytes = sizeof(std::uint64_t);

std::uint64_t checkOf(std::string_view bytes, std::uint64_t chain) {
  return contentHash(bytes, chain);
}

}  // namespace

void appendBlock(BlockKind kind, std::string_view payload, std::uint64_t& chain, std::string& bytes) {
  LORICA_CHECK(payload.size() <= kLargestBlock, "the payload of a block is too large");
  const auto put = [&](const auto& number) { bytes.append(reinterpret_cast<const char*>(&number), sizeof(number)); };
  const std::size_t begin = bytes.size();
  put(static_cast<std::uint32_t>(kind));
  put(static_cast<std::uint32_t>(payload.size()));
  const std::uint64_t head = checkOf(std::string_view(bytes).substr(begin, kHeadBytes), chain);
  put(head);
  bytes.append(payload);
  chain = checkOf(payload, head);
  put(chain);
}

Result<Blocks> readBlocks(std::string_view bytes, const std::string& name) {
  const auto damaged = [&](std::size_t offset, std::string_view what) {
    return badFormat("{}: byte {}: {}", name, offset, what);
  };
  if (bytes.substr(0, kSessionMagic.size()) != kSessionMagic) {
    return badFormat("{}: not a session file, expected a file written by `lorica record`; `lorica FILE` opens others",
                     name);
  }
  Blocks read;
  std::uint64_t chain = 0;
  std::size_t at = kSessionMagic.size();
  while (at < bytes.size()) {
    const std::string_view rest = bytes.substr(at);
    const std::size_t headSize = kHeadBytes + kCheckBytes;
    if (rest.size() < headSize) break;
    if (workStopped()) return cancelled();
    ByteReader head(rest.substr(0, headSize));
    const auto kind = head.take<std::uint32_t>();
    const auto length = head.take<std::uint32_t>();
    const auto headCheck = head.take<std::uint64_t>();
    if (checkOf(rest.substr(0, kHeadBytes), chain) != headCheck) {
      return damaged(at, fmt::format("the header of block {} is damaged: its checksum is wrong", read.blocks.size()));
    }
    if (kind < 1 || kind > static_cast<std::uint32_t>(BlockKind::kEnd)) {
      return damaged(at, fmt::format("found a block of kind {}, expected 1 to 4", kind));
    }
    if (length > kLargestBlock) {
      return damaged(at, fmt::format("found a block of {} bytes, expected at most {}", length, kLargestBlock));
    }
    if (rest.size() < headSize + length + kCheckBytes) break;
    const std::string_view payload = rest.substr(headSize, length);
    ByteReader tail(rest.substr(headSize + length, kCheckBytes));
    chain = checkOf(payload, headCheck);
    if (tail.take<std::uint64_t>() != chain) {
      return damaged(at, fmt::format("block {} is damaged: its checksum is wrong", read.blocks.size()));
    }
    read.blocks.push_back({static_cast<BlockKind>(kind), payload, at});
    at += headSize + length + kCheckBytes;
  }
  read.cut = bytes.size() - at;
  return read;
}

Result<SessionFile> parseSession(std::string_view bytes, const std::string& name) {
  LORICA_TRY(Blocks blocks, readBlocks(bytes, name));
  const auto bad = [&](const std::string& what) { return badFormat("{}: {}", name, what); };
  const std::vector<Block>& all = blocks.blocks;
  if (all.size() < 2 || all[0].kind != BlockKind::kHeader || all[1].kind != BlockKind::kScene) {
    return bad(fmt::format("found {} complete blocks, expected a header, a scene and steps", all.size()));
  }
  LORICA_TRY(SessionHeader header, parseSessionHeader(all[0].payload, name));
  SessionFile file;
  file.header = std::move(header);
  file.sceneText = std::string(all[1].payload);
  file.steps.reserve(all.size());
  file.motions.resize(file.header.avatars.size());
  std::size_t taken = 0;
  for (std::size_t b = 2; b < all.size(); ++b) {
    if (workStopped()) return cancelled();
    if (file.finished) return bad(fmt::format("byte {}: a block after the end", all[b].offset));
    if (all[b].kind == BlockKind::kStep) {
      if (const auto wrong = StepReader(all[b].payload, file.header, file, taken).read()) {
        return bad(fmt::format("byte {}: step {} {}", all[b].offset, file.steps.size(), *wrong));
      }
    } else if (all[b].kind == BlockKind::kEnd && all[b].payload.empty()) {
      file.finished = true;
    } else {
      return bad(fmt::format("byte {}: found a second header or scene, or an end block with a payload, expected steps",
                             all[b].offset));
    }
  }
  if (file.finished && blocks.cut > 0) return bad("bytes after the end");
  if (file.steps.empty()) return bad("found no steps, expected at least one");
  if (blocks.cut > 0) {
    file.notes.push_back(counted(std::int64_t(blocks.cut), "byte at the end is", "bytes at the end are") +
                         " an incomplete step, which was dropped");
  }
  if (!file.finished) file.notes.emplace_back("the recording was not closed: the program ended early");
  return file;
}

Result<SessionFile> readSession(const std::filesystem::path& file) {
  LORICA_TRY(const std::string bytes, readFile(file, NamedBy::kUser, kMaxSessionBytes));
  return parseSession(bytes, file.string());
}

}  // namespace lorica
