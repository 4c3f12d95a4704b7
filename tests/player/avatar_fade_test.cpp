#include "player/snapshots.h"

#include "capture/files/joint_csv.h"
#include "session/treated_source.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/session/small_session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace lorica {
namespace {

using Frames = std::vector<SkeletonFrame>;

SessionAvatar avatarOf(Frames frames) {
  return SessionAvatar::create(makeMannequin(), test::eightParts(),
                               makeTreatedSource(makeMannequin(), makeRecordedSource(std::move(frames)), {}).value())
      .value();
}

/// Two who wave, 30 frames a second; nobody is the second from frame 10 to 39.
Session twoWaves() {
  const Frames always = test::shippedFrames("wave", 80);
  Frames sometimes = always;
  for (std::size_t frame = 10; frame < 40; ++frame) {
    sometimes[frame].user = kNobody;
    sometimes[frame].joints = {};
  }
  Session session(World{});
  session.addAvatar(avatarOf(always));
  session.addAvatar(avatarOf(sometimes));
  return session;
}

TEST(AvatarFade, WhoLeavesAndComesFadesInHalfASecondOfTheSession) {
  Session session = twoWaves();
  AvatarFade fade;
  std::vector<double> visible, seconds;
  while (session.step().value()) {
    fade.update(session);
    fade.update(session);  // a second picture of the frame changes nothing
    EXPECT_EQ(fade.of(session, 0), 1.0);
    visible.push_back(fade.of(session, 1));
    seconds.push_back(session.time());
    EXPECT_EQ(session.avatar(1).partsInWorld().empty(), !session.avatar(1).present()) << "it strikes nothing at once";
  }
  ASSERT_EQ(visible.size(), 80u);
  for (std::size_t frame = 0; frame < visible.size(); ++frame) {
    const double gone = seconds[std::min<std::size_t>(frame, 39)] - seconds[9];
    const double back = seconds[frame] - seconds[39];
    const double expected = frame < 10 ? 1.0 : std::max(1.0 - gone / 0.5, 0.0) + std::max(back / 0.5, 0.0);
    EXPECT_NEAR(visible[frame], std::min(expected, 1.0), 1e-9) << frame;
  }
}

TEST(AvatarFade, WhoIsThereInTheFirstFrameIsVisibleAtOnceAlsoAfterARestart) {
  Session session = twoWaves();
  AvatarFade fade;
  EXPECT_EQ(fade.of(session, 0), 0.0) << "nobody has come yet";
  for (int frame = 0; frame < 30; ++frame) {
    ASSERT_TRUE(session.step().value());
    fade.update(session);
  }
  EXPECT_EQ(fade.of(session, 1), 0.0);
  session = twoWaves();
  ASSERT_TRUE(session.step().value());
  fade.update(session);
  EXPECT_EQ(fade.of(session, 1), 1.0);
}

}  // namespace
}  // namespace lorica
