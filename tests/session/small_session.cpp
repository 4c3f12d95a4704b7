#include "tests/session/small_session.h"

#include "acd/decompose.h"
#include "capture/files/joint_csv.h"
#include "session/scenes/demo_scene.h"
#include "session/treated_source.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lorica::test {

const Decomposition& eightParts() {
  static const Decomposition parts = [] {
    const Character character = makeMannequin();
    DecomposeSettings settings;
    settings.maxParts = 8;
    const PoseView bindPose{character.mesh.vertices, static_cast<int>(character.mesh.vertices.size())};
    return decompose(character.mesh, bindPose, settings).value();
  }();
  return parts;
}

std::vector<SkeletonFrame> shippedFrames(const std::string& name, std::size_t count, double from) {
  Result<std::vector<SkeletonFrame>> read = readJointCsv(recordingsFolder() / (name + ".csv"));
  EXPECT_TRUE(read.ok()) << read.error().message;
  std::vector<SkeletonFrame> frames = std::move(read).value();
  std::erase_if(frames, [from](const SkeletonFrame& frame) { return frame.time < from; });
  frames.resize(std::min(frames.size(), count));
  return frames;
}

Session demoSession(std::unique_ptr<PoseSource> source) {
  Result<Session> session = Session::create(makeMannequin(), eightParts(), std::move(source), makeDemoWorld(kDemoSeed));
  LORICA_CHECK(session.ok(), "the mannequin fits its own decomposition");
  return std::move(session).value();
}

SessionHeader headerOf(const Session& session) {
  SessionHeader header;
  header.avatar().source = "a test";
  header.avatar().character = "mannequin";
  header.avatar().characterHash = hashOf(session.character());
  header.avatar().decompositionHash = hashOf(session.body().decomposition());
  header.sceneSeed = kDemoSeed;
  header.worldHash = hashOf(session.world());
  return header;
}

int recordJoints(const std::filesystem::path& file, std::vector<SkeletonFrame> frames, const FaultSettings& faults,
                 const JointSettings& joints) {
  // As in playback, the world and the character are known before there is a source.
  SessionHeader header = headerOf(demoSession(makeMotionPoseSource({})));
  header.avatar().faults = faults;
  header.avatar().joints = joints;
  const auto recorder = SessionRecorder::start(file, header, "").value();
  Session session = demoSession(
      makeTreatedSource(makeMannequin(), makeRecordedSource(std::move(frames)), {recorder->log(), faults, joints})
          .value());
  session.watch(recorder);
  while (true) {
    if (session.frameCount() == 5) session.act(WorldAction::throwBall({0.0, 1.2, 1.5}, {0.0, 1.0, -6.0}, 0.1));
    if (session.frameCount() == 8) session.act(WorldAction::grab(0, {0.0, 0.1, 0.6}));
    if (session.frameCount() == 9) session.act(WorldAction::moveGrab({0.3, 0.8, 0.8}));
    if (session.frameCount() == 20) session.act(WorldAction::release());
    const Result<bool> more = session.step();
    EXPECT_TRUE(more.ok()) << more.error().message;
    if (!more || !*more) break;
  }
  const Result<int> steps = recorder->finish();
  EXPECT_TRUE(steps.ok()) << steps.error().message;
  return steps ? *steps : 0;
}

}  // namespace lorica::test
