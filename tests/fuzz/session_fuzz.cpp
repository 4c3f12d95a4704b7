#include "session/recording/session_file.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

/// Any bytes as a session file: as they are where they begin like one; else header, scene and steps divided by zero
/// bytes of two, put into blocks with the right checksums, which no fuzzer finds.
namespace {

using namespace lorica;

/// What precedes the next mark, which is removed.
std::string_view take(std::string_view& rest) {
  constexpr std::string_view kMark("\0\0\xff", 3);
  const std::size_t end = rest.find(kMark);
  const std::string_view first = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + kMark.size());
  return first;
}

std::string fileOf(std::string_view rest) {
  std::string bytes(kSessionMagic);
  std::uint64_t chain = 0;
  appendBlock(BlockKind::kHeader, take(rest), chain, bytes);
  appendBlock(BlockKind::kScene, take(rest), chain, bytes);
  while (!rest.empty()) appendBlock(BlockKind::kStep, take(rest), chain, bytes);
  appendBlock(BlockKind::kEnd, {}, chain, bytes);
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const std::string file = bytes.starts_with(kSessionMagic) ? std::string(bytes) : fileOf(bytes);
  const Result<SessionFile> session = parseSession(file, "fuzz");
  if (!session) {
    LORICA_CHECK(session.error().message.rfind("fuzz", 0) == 0, "an error that does not name the file");
    return 0;
  }
  std::size_t taken = 0, actions = 0, held = 0;
  for (const SessionStep& step : session->steps) {
    taken += step.frames;
    actions += step.actions;
  }
  LORICA_CHECK(!session->steps.empty(), "accepted without a step");
  LORICA_CHECK(session->motions.size() == session->header.avatars.size(), "an avatar got lost");
  for (std::size_t a = 0; a < session->motions.size(); ++a) {
    const RecordedMotion& motion = session->motions[a];
    held += motion.joints.size() + motion.poseTimes.size();
    LORICA_CHECK(
        motion.poses.size() == motion.poseTimes.size() * static_cast<std::size_t>(session->header.avatar(a).poseJoints),
        "half a pose");
    for (const JointTransform& t : motion.poses) LORICA_CHECK(t.translation.allFinite(), "a joint nowhere");
  }
  LORICA_CHECK(taken == held && actions == session->actions.size(), "frames got lost");
  return 0;
}
