#include "session/prepare/live_cast.h"

#include "capture/streams/packet_file.h"
#include "geometry/clock.h"
#include "geometry/work_budgets.h"
#include "session/prepare/scenes.h"
#include "session/prepare/stream_motion.h"
#include "tests/capture/streams/vmc_packet.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lorica::test {
namespace {

/// Poses for some seconds from now on, so that a slow machine does not run out of them.
void holdAt(const Vec3& position, WornHeadset& headset) {
  const double begin = now() - 1.0;
  headset.restart();
  for (int i = 0; i < 120; ++i) headset.add(begin + 0.09 * i, position, Quat::Identity());
}

TEST(LiveCast, ThePersonsHeadIsWhereTheirHeadsetIs) {
  Host host;
  LiveRequest live;
  live.depth.virtualCamera = true;
  const LiveCast made = test::valueOf(prepareLiveCast({}, live, host));
  const LiveSources& sources = *made.sources;
  ASSERT_TRUE(sources.headset);
  const auto followed = [&](bool worn) {
    for (int i = 0; i < 300; ++i) {
      (void)test::valueOf(sources.joints[0]->next());
      if (sources.tracked->sight().followed && sources.tracked->sight().worn.has_value() == worn) return true;
    }
    return false;
  };
  ASSERT_TRUE(followed(false));
  SkeletonFrame person = sources.tracked->sight().joints;
  EXPECT_EQ(sources.withHead(person)[BodyJoint::kHead].position, person[BodyJoint::kHead].position);

  Registration known;
  known.translation = {0.2, 0.0, 3.0};
  sources.headset->setRegistration(known);
  const Vec3 stage = sources.tracked->sight().stage;
  const Vec3 head = person[BodyJoint::kHead].position + stage + Vec3(0.05, 0.02, 0.0);
  holdAt(head + known.translation - known.headInHeadset, *sources.headset);
  ASSERT_TRUE(followed(true));
  person = sources.withHead(sources.tracked->sight().joints);
  EXPECT_LT((person[BodyJoint::kHead].position + stage - head).norm(), 1e-9);
  EXPECT_EQ(person[BodyJoint::kHead].confidence, 1.0);
}

/// After the demo's, which has no file; whatever is shown, and also where the shown one is the user's own.
TEST(Scenes, TheEmptyStageIsOfferedFirstAndHasAFloorAlone) {
  Host host;
  for (const std::string& present :
       {std::string(), std::string(kEmptyStage), std::string("pool"), std::string("/a/b.json")}) {
    const SceneList list = scenesNextTo(present);
    EXPECT_EQ(list.names[1], kEmptyStage);
    EXPECT_EQ(list.arguments[1], kEmptyStage);
    EXPECT_EQ(std::ranges::count(list.names, kEmptyStage), 1);
    EXPECT_EQ(list.arguments[static_cast<std::size_t>(list.present)], present);
  }
  World world = test::valueOf(openScene(kEmptyStage, 1.0, host));
  EXPECT_TRUE(world.props().empty());
  EXPECT_TRUE(world.hasFloor());
  EXPECT_EQ(world.particles(), nullptr);
  world.step({}, 1.0 / 30.0);
}

TEST(PacketMotion, FramesAreReadUpToTheirLimit) {
  const TemporaryFolder folder;
  std::string bytes = packetFileHeader();
  Packet hips;
  hips.bundle().bone("Hips");
  std::uint64_t microseconds = 0;
  const auto add = [&] { bytes += packetRecord(hips.bytes(), microseconds += 16'667, 5000, 39539); };
  for (std::size_t i = 0; i < kMaxStreamFrames; ++i) add();
  Host host;
  const Motion most = valueOf(readPacketMotion(folder.write("most.pcap", bytes), {}, host));
  EXPECT_EQ(most.bones->times.size(), kMaxStreamFrames);
  add();
  EXPECT_TRUE(has(errorOf(readPacketMotion(folder.write("more.pcap", bytes), {}, host)).message,
                  "found 216001 frames of bones, expected at most 216000"));
}

}  // namespace
}  // namespace lorica::test
