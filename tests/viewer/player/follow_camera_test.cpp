#include "viewer/player/follow_camera.h"

#include "capture/files/joint_csv.h"
#include "session/treated_source.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/session/small_session.h"
#include "tests/support/value_of.h"
#include "viewer/player/snapshots.h"
#include "viewer/renderer/picture_area.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace lorica {
namespace {

using Frames = std::vector<SkeletonFrame>;

/// The mannequin in its first frames of a walk, as if its file had another height: lying, or half of it cut off.
Session walkingSession(double heightFactor) {
  Character character = makeMannequin();
  character.height *= heightFactor;
  auto source = test::valueOf(
      makeTreatedSource(character, makeRecordedSource(test::shippedFrames("walk", 3)), SourceTreatment{}));
  return test::valueOf(Session::create(std::move(character), test::eightParts(), std::move(source), World()));
}

/// The farthest point of the body from the middle of the picture, in halves of its height and of its width.
std::pair<double, double> reach(const Session& session, const Camera& camera, double aspect) {
  const Vec3 forward = (camera.target - camera.eye).normalized();
  const Vec3 right = forward.cross(Vec3::UnitY()).normalized();
  const Vec3 up = right.cross(forward);
  const double half = std::tan(0.5 * camera.verticalFov);
  double across = 0.0, upward = 0.0;
  for (const LivePart& part : session.body().parts()) {
    for (const Vec3& p : part.shape.vertices) {
      const Vec3 from = part.worldFromPart * p - camera.eye;
      const double depth = from.dot(forward) * half;
      upward = std::max(upward, std::abs(from.dot(up)) / depth);
      across = std::max(across, std::abs(from.dot(right)) / (depth * aspect));
    }
  }
  return {upward, across};
}

TEST(FollowCamera, ShowsTheWholeBodyWhateverTheHeightOfItsFile) {
  for (const double factor : {0.1, 0.3, 0.6, 1.0, 3.0}) {
    SCOPED_TRACE(factor);
    for (const auto& [width, height] : {std::pair(1280, 720), std::pair(400, 400), std::pair(300, 600)}) {
      Session session = walkingSession(factor);
      FollowCamera camera({}, 1.0 * width / height);
      while (*session.step()) {
        camera.update(session, 1.0 / 30.0);
        const auto [upward, across] = reach(session, camera.camera(), static_cast<double>(width) / height);
        EXPECT_LE(upward, 1.0);
        EXPECT_LE(across, 1.0);
        EXPECT_GE(std::max(upward, across), 0.35);  // and is no dot in it
      }
    }
  }
}

TEST(FollowCamera, AStillHasTheBodyInItsMiddleAndFillsThePicture) {
  for (const char* preset : {"front", "side", "back", "top", "three-quarter"}) {
    SCOPED_TRACE(preset);
    for (const auto& [width, height] : {std::pair(1280, 720), std::pair(720, 1280)}) {
      Session session = walkingSession(1.0);
      FollowCamera camera({preset}, 1.0 * width / height);
      while (*session.step()) camera.update(session, 1.0 / 30.0);
      const Camera still = camera.still(session);
      Eigen::AlignedBox2d seen;
      for (const LivePart& part : session.body().parts()) {
        for (const Vec3& p : part.shape.vertices) {
          const ViewAxes axes = axesOf(still);
          const Vec3 from = part.worldFromPart * p - still.eye;
          const double half = from.dot(axes.forward) * std::tan(0.5 * still.verticalFov);
          seen.extend(Eigen::Vector2d(from.dot(axes.right) * height / width, from.dot(axes.up)) / half);
        }
      }
      EXPECT_LT(seen.center().cwiseAbs().maxCoeff(), 0.08);
      EXPECT_GT(seen.sizes().maxCoeff(), 1.3);
      EXPECT_LE(seen.max().cwiseAbs().cwiseMax(seen.min().cwiseAbs()).maxCoeff(), 1.0);
      EXPECT_EQ(camera.still(session).eye, still.eye) << "a picture does not depend on those before it";
    }
  }
}

TEST(FollowCamera, LooksFromWhereTheAvatarFaces) {
  for (const double turn : {0.0, 2.0}) {
    Session session = walkingSession(1.0);
    ASSERT_TRUE(*session.step());
    SessionAvatar turned = session.avatar().another(test::valueOf(
        makeTreatedSource(session.character(), makeRecordedSource(test::shippedFrames("walk", 3)), SourceTreatment{})));
    turned.setPlace(Isometry3(Eigen::AngleAxisd(turn, Vec3::UnitY())));
    Session other{World()};
    other.addAvatar(std::move(turned));
    ASSERT_TRUE(*other.step());
    const double facing = facingOf(session.avatar()) + turn;
    EXPECT_NEAR(std::remainder(facingOf(other.avatar()) - facing, 2.0 * EIGEN_PI), 0.0, 1e-9);
    for (const auto& [preset, off] : {std::pair("front", 0.0), {"three-quarter", 35.0}, {"side", 90.0}}) {
      FollowCamera camera({preset}, 640.0 / 360);
      const Camera still = camera.still(other);
      const Vec3 to = still.eye - still.target;
      const double angle = std::remainder(facing - std::atan2(to.x(), to.z()), 2.0 * EIGEN_PI);
      EXPECT_NEAR(angle * 180.0 / EIGEN_PI, off, 1e-6) << preset;
    }
  }
}

TEST(FollowCamera, AFaceIsAPortrait) {
  Session session = walkingSession(1.0);
  ASSERT_TRUE(*session.step());
  FollowCamera camera({"face"}, 640.0 / 360);
  const Camera face = camera.still(session);
  const double seen = 2.0 * (face.eye - face.target).norm() * std::tan(0.5 * face.verticalFov);
  EXPECT_GT(seen, 0.25) << "the head";
  EXPECT_LT(seen, 0.70) << "and not much more";
  const JointIndex head = session.character().skeleton.jointOf(HumanBone::kHead);
  EXPECT_LT((face.target - session.worldFromJoint()[head].translation()).norm(), 0.2);
}

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
