#include "tests/viewer/renderer/picture_error.h"
#include "tests/viewer/renderer/pictures.h"
#include "tests/viewer/vr/headsets.h"
#include "viewer/pictures/image_files.h"
#include "viewer/player/snapshots.h"
#include "viewer/window/window.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace lorica::test {
namespace {

/// The middle of what is red [pixels].
Eigen::Vector2d redIn(const Image& image) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int count = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const auto [r, g, b] = pixelAt(image, x, y);
      if (r < 90 || g > r / 3 || b > r / 3) continue;
      sum += Eigen::Vector2d(x, y);
      ++count;
    }
  }
  return count > 0 ? Eigen::Vector2d(sum / count) : Eigen::Vector2d(-1e6, 0.0);
}

class HeadsetEyes : public Headsets {
 protected:
  void expectPicturesOfCameras();
};

/// What the eyes were shown is what an off-screen picture shows by cameras there.
void HeadsetEyes::expectPicturesOfCameras() {
  told.head = {{0.3, 1.55, 0.2}, Quat(Eigen::AngleAxisd(0.2, Vec3::UnitY()))};
  told.angles = {-std::atan(0.6 * 4.0 / 3.0), std::atan(0.6 * 4.0 / 3.0), std::atan(0.6), -std::atan(0.6)};
  Choices& choices = window->choices();
  choices.paused = true;
  choices.steps = 1;
  choices.show.hulls = choices.show.colorSkinByPart = false;
  window->setQuality(RenderQuality::kHigh);
  std::array<Image, 2> seen;
  std::array<Camera, 2> cameras;
  HeadsetFrame drawn;
  int after = 0;
  playUntil([&] {
    if (!arrived() || run->session.frameCount() == 0 || ++after < 5) return false;
    for (const int eye : {0, 1}) seen[eye] = window->headset()->picture(eye);
    for (const int eye : {0, 1}) {
      // What the renderer can do itself: a camera without roll, from the angles that were told.
      const Isometry3 worldFromEye = window->place().worldFromStage() * frame().eyes[eye].stageFromEye;
      cameras[eye].eye = worldFromEye.translation();
      cameras[eye].target = worldFromEye * Vec3(0, 0, -2.5);
      cameras[eye].verticalFov = 2.0 * std::atan(0.6);
      cameras[eye].aspect = 4.0 / 3.0;
      cameras[eye].nearest = 0.05;
    }
    drawn = frame();
    return true;
  });
  if (HasFailure()) return;
  const SceneOptions show = window->choices().show;
  const Isometry3 worldFromStage = window->place().worldFromStage();
  window.reset();
  const Vec3 apart = drawn.eyes[1].stageFromEye.translation() - drawn.eyes[0].stageFromEye.translation();
  std::printf("eyes %d x %d, %.1f mm apart\n", seen[0].width, seen[0].height, 1e3 * apart.norm());
  for (const int eye : {0, 1}) {
    const EyeAngles& angles = drawn.eyes[eye].angles;
    EXPECT_NEAR(angles.right, told.angles.right, 1e-5);
    EXPECT_NEAR(angles.up, told.angles.up, 1e-5);
    if (const char* to = std::getenv("LORICA_VR_PICTURES")) {
      EXPECT_TRUE(writePng(fmt::format("{}/eye_{}.png", to, eye), seen[eye]));
    }
  }
  LORICA_REQUIRE_STUDIO(studio, "");
  SessionScene scene(run->session);
  scene.follow(run->session);
  std::array<Eigen::Vector2d, 2> ball, expected;
  for (const int eye : {0, 1}) {
    const Camera& camera = cameras[eye];
    const Image alone =
        studio->draw(scene.of(run->session, show, camera.eye), show, camera, seen[eye].width, seen[eye].height);
    const PictureError error = pictureError(seen[eye], alone);
    std::printf("eye %d: %.3f %% of the pixels differ\n", eye, 100.0 * error.wrong);
    EXPECT_LT(error.wrong, 0.002);
    if (const char* to = std::getenv("LORICA_VR_PICTURES")) {
      EXPECT_TRUE(writePng(fmt::format("{}/alone_{}.png", to, eye), alone));
    }
    ball[eye] = redIn(seen[eye]);
    // By similar triangles.
    const Vec3 in = (worldFromStage * drawn.eyes[eye].stageFromEye).inverse() * Vec3(0.5, 1.3, 0.3);
    expected[eye] = {0.5 * seen[eye].width * (1.0 - in.x() / in.z() / 0.8), 0.0};
  }
  std::printf("parallax of the ball %.2f px, %.2f by similar triangles\n", ball[0].x() - ball[1].x(),
              expected[0].x() - expected[1].x());
  EXPECT_NEAR(ball[0].x() - ball[1].x(), expected[0].x() - expected[1].x(), 0.5);
}

TEST_F(HeadsetEyes, SeeWhatCamerasThereSee) {
  expectPicturesOfCameras();
}

TEST_F(HeadsetEyes, SeeTheSameWithoutADisplay) {
  openUnseen();
  ASSERT_EQ(std::getenv("DISPLAY"), nullptr);
  expectPicturesOfCameras();
}

TEST_F(Headsets, InsideTheEyesAreThoseOfTheAvatar) {
  Choices& choices = window->choices();
  choices.paused = choices.inside = true;
  choices.steps = 1;
  told.head = {{0.5, 1.2, -0.4}, Quat(Eigen::AngleAxisd(-0.5, Vec3::UnitX()))};
  Isometry3 worldFromHead;
  int after = 0;
  playUntil([&] {
    if (!arrived() || run->session.frameCount() == 0 || ++after < 5) return false;
    worldFromHead = window->place().worldFromStage() * frame().stageFromHead;
    if (const char* to = std::getenv("LORICA_VR_PICTURES")) {
      EXPECT_TRUE(writePng(fmt::format("{}/inside.png", to), window->headset()->picture(0)));
    }
    return true;
  });
  const SessionAvatar& avatar = run->session.avatar();
  const Vec3 joint = avatar.worldFromJoint()[avatar.character().skeleton.jointOf(HumanBone::kHead)].translation();
  const Vec3 away = worldFromHead.translation() - joint;
  EXPECT_NEAR(away.y(), 0.07, 1e-6);
  EXPECT_NEAR(std::hypot(away.x(), away.z()), 0.09, 1e-6);
}

TEST_F(Headsets, AnAvatarFollowsHeadAndHands) {
  const std::filesystem::path file = folder_.path() / "worn.lsession";
  follow(file.string());
  told.head = {{0.4, 1.6, -0.2}, Quat(Eigen::AngleAxisd(0.4, Vec3::UnitY()))};
  told.hands = {Told{{-0.1, 1.3, -0.6}}, Told{{0.5, 1.1, -0.5}}};
  const auto jointAt = [&](HumanBone bone) -> Vec3 {
    const SessionAvatar& avatar = run->session.avatar();
    return avatar.worldFromJoint()[avatar.character().skeleton.jointOf(bone)].translation();
  };
  double off = 0.0, apart = 0.0;
  Vec3 before, walked;
  int after = 0;
  std::array<std::vector<double>, 4> times;
  double last = 0.0;
  long dropped = 0;
  playUntil([&] {
    for (std::size_t i = 0; i < 3; ++i) times[i].push_back(window->times()[i].milliseconds);
    times[3].push_back(1e3 * frame().ahead);
    if (last > 0.0) dropped += std::max(0L, std::lround((frame().time - last) / frame().period) - 1);
    last = frame().time;
    if (!arrived() || run->session.frameCount() < 20 || ++after < 30) return false;
    if (after > 30) return after > 60;
    // The wearer looks out of the avatar's head, and the hands are where theirs are.
    const Isometry3 worldFromHead = window->place().worldFromStage() * frame().stageFromHead;
    before = jointAt(HumanBone::kHead);
    off = (worldFromHead * kNominalHeadInHeadset - before).norm();
    for (const int hand : {0, 1}) {
      const Vec3 grip = window->place().worldFromStage() * frame().hands[hand].stageFromGrip.translation();
      const HumanBone wrist = hand == 0 ? HumanBone::kLeftHand : HumanBone::kRightHand;
      apart = std::max(apart, (grip - jointAt(wrist)).norm());
    }
    if (const char* to = std::getenv("LORICA_VR_PICTURES")) {
      EXPECT_TRUE(writePng(fmt::format("{}/worn.png", to), window->headset()->picture(0)));
    }
    // They walk half a metre: so does the avatar.
    walked = window->place().worldFromStage().linear() * Vec3(0.0, 0.0, -0.5);
    told.head.at.z() -= 0.5;
    for (Told& hand : told.hands) hand.at.z() -= 0.5;
    return false;
  });
  for (std::vector<double>& stage : times) std::ranges::nth_element(stage, stage.begin() + std::ssize(stage) / 2);
  const auto median = [&](int stage) { return times[stage][times[stage].size() / 2]; };
  std::printf(
      "wait %.1f ms, eyes %.1f ms, hand over %.1f ms; poses are predicted by %.1f ms (medians); %ld pictures dropped\n",
      median(0), median(1), median(2), median(3), dropped);
  EXPECT_NE(median(3), 0.0);
  EXPECT_TRUE(window->choices().inside);
  std::printf("head within %.2f mm, wrists within %.0f mm of the controllers\n", 1e3 * off, 1e3 * apart);
  EXPECT_LT(off, 1e-3);
  EXPECT_LT(apart, 0.2);  // a wrist is 8 cm from the palm, and the mannequin is smaller than the wearer
  const Vec3 went = jointAt(HumanBone::kHead) - before;
  EXPECT_LT((went - walked).norm(), 0.1) << went.transpose();
  expectReplayed(file);
}

TEST_F(Headsets, WithARegistrationTheAvatarsHeadIsTheWearers) {
  WearerState state;
  state.registration.emplace();
  state.registration->yaw = 0.7;
  state.registration->translation = {0.3, 0.0, -1.2};
  state.registration->headInHeadset = {0.0, -0.08, 0.12};
  state.origin = {0.1, 0.0, 2.0};
  Choices& choices = window->choices();
  choices.paused = choices.inside = true;
  choices.steps = 1;
  told.head = {{0.5, 1.5, -0.4}, Quat(Eigen::AngleAxisd(0.9, Vec3::UnitY()))};
  int after = 0;
  playUntil([&] {
    if (after == 0) window->setWearer(state);
    return arrived() && run->session.frameCount() > 0 && ++after > 5;
  });
  const Isometry3& worldFromStage = window->place().worldFromStage();
  EXPECT_TRUE(worldFromStage.linear().isApprox(Eigen::AngleAxisd(-0.7, Vec3::UnitY()).toRotationMatrix(), 1e-9));
  const SessionAvatar& avatar = run->session.avatar();
  const Vec3 joint = avatar.worldFromJoint()[avatar.character().skeleton.jointOf(HumanBone::kHead)].translation();
  EXPECT_LT((worldFromStage * frame().stageFromHead * state.registration->headInHeadset - joint).norm(), 1e-3);
}

TEST_F(Headsets, ABareHandHoldsABoxInItsFist) {
  told.bare = true;
  const auto box = [&] { return run->session.world().props()[2]; };
  int waited = 0;
  Vec3 first;
  playUntil([&] {
    if (!arrived() || run->session.frameCount() < 2) return false;
    const HeadsetHand& hand = frame().hands[1];
    if (waited == 0) first = box().worldFromProp.translation();
    told.hands[1].at = window->place().worldFromStage().inverse() * (first + Vec3(0.0, 0.0, 0.15));
    if (!hand.seen || !hand.bare || ++waited < 10) return false;
    if (waited == 10) {
      EXPECT_FALSE(hand.grabs) << "an open hand";
    }
    told.fists[1] = 1.0;
    return run->session.world().held(1).has_value();
  });
}

TEST_F(Headsets, AControllerHoldsABoxAndThrowsIt) {
  const std::filesystem::path file = folder_.path() / "thrown.lsession";
  start(file.string());
  enum class Step { kComing, kAiming, kLifting, kFlying } step = Step::kComing;
  const auto box = [&] { return run->session.world().props()[2]; };
  constexpr double kHandSpeed = 3.0;  // [m/s]
  Vec3 first;
  double letGoAt = 0.0, highest = 0.0, time = 0.0;
  int waited = 0;
  playUntil([&]() -> bool {
    if (!arrived() || run->session.frameCount() < 2) return false;
    Told& hand = told.hands[1];
    const double seconds = frame().time - std::exchange(time, frame().time);
    const bool there = frame().hands[1].seen && (frame().hands[1].stageFromGrip.translation() - hand.at).norm() < 1e-3;
    switch (step) {
      case Step::kComing: {  // the hand comes to the box, the trigger is free
        first = box().worldFromProp.translation();
        hand.at = window->place().worldFromStage().inverse() * (first + Vec3(0.0, 0.0, 0.15));
        if (there && ++waited > 3) step = Step::kAiming;
        return false;
      }
      case Step::kAiming:
        told.triggers[1] = 1.0;
        if (run->session.world().held(1)) step = Step::kLifting;
        return false;
      case Step::kLifting:
        hand.at.y() += kHandSpeed * seconds;
        letGoAt = box().worldFromProp.translation().y();
        if (letGoAt < first.y() + 0.4) return false;
        told.triggers[1] = 0.0;
        step = Step::kFlying;
        return false;
      case Step::kFlying:
        hand.at.y() += kHandSpeed * seconds;  // a hand does not stop where it lets go
        if (run->session.world().held(1)) {
          letGoAt = box().worldFromProp.translation().y();
          return false;
        }
        highest = std::max(highest, box().worldFromProp.translation().y());
        return box().velocity.y() < 0.0 && box().worldFromProp.translation().y() < highest;
    }
    return false;
  });
  const double thrown = std::sqrt(2.0 * 9.81 * std::max(highest - letGoAt, 0.0));
  std::printf("the hand moved at %.1f m/s, the box flew up as if thrown at %.1f m/s\n", kHandSpeed, thrown);
  EXPECT_GT(thrown, 0.6 * kHandSpeed);
  EXPECT_LT(thrown, 2.0 * kHandSpeed);
  expectReplayed(file);
}

TEST_F(Headsets, WhenTheRuntimeEndsTheSessionGoesOnInTheWindowUntilItIsBack) {
  int lost = 0, frames = 0;
  playUntil([&] {
    if (arrived() && run->session.frameCount() > 2) {
      endService();
      return false;
    }
    if (window->headset() != nullptr) return false;
    if (lost++ == 0) frames = run->session.frameCount();
    return lost > 30;
  });
  EXPECT_NE(window->ended().find("the session goes on in the window"), std::string::npos) << window->ended();
  EXPECT_GT(run->session.frameCount(), frames);
  EXPECT_TRUE(window->open());
  // The service starts again: the headset is taken again.
  ASSERT_NO_FATAL_FAILURE(startService());
  const int later = run->session.frameCount();
  playUntil([&] { return arrived() && run->session.frameCount() > later; });
  EXPECT_TRUE(window->ended().empty()) << window->ended();
}

TEST_F(Headsets, WithoutADisplayALostHeadsetIsSaidAndTakenAgain) {
  openUnseen();
  int lost = 0;
  playUntil([&] {
    if (arrived() && run->session.frameCount() > 2) endService();
    if (window->headset() == nullptr) ++lost;
    return lost > 30;
  });
  ASSERT_FALSE(said.empty());
  EXPECT_NE(said.back().find("the session goes on without it"), std::string::npos) << said.back();
  EXPECT_TRUE(window->open());
  ASSERT_NO_FATAL_FAILURE(startService());
  playUntil([&] { return arrived(); });
  EXPECT_EQ(said.back(), "the headset is there again");
}

// A run of another kind begins in the same window: what the headset was told of the run before holds no longer.
TEST_F(Headsets, AnotherRunForgetsWhatTheWearerWasTold) {
  follow({});
  playUntil([&] { return arrived() && window->choices().inside; });
  const Isometry3 worn = window->place().worldFromStage();
  start();
  told.head.at.x() += 0.4;
  int after = 0;
  playUntil([&] { return arrived() && run->session.frameCount() > 2 && ++after > 5; });
  EXPECT_FALSE(window->choices().inside) << "a played motion is seen from beside it";
  const SessionAvatar& avatar = run->session.avatar();
  const Vec3 joint = avatar.worldFromJoint()[avatar.character().skeleton.jointOf(HumanBone::kHead)].translation();
  const Vec3 away = window->place().worldFromStage() * frame().stageFromHead.translation() - joint;
  EXPECT_GT(std::hypot(away.x(), away.z()), 1.0) << worn.translation().transpose();
}

// A page's clients count from 0: a headset of this machine is none of them, and its clock is learnt when it is heard.
TEST_F(Headsets, TheWindowsWearerIsNoClientOfAPage) {
  playUntil([&] { return arrived(); });
  int heard = 0;
  host.ends = nullptr;
  for (int i = 0; i < kPatience && heard == 0; ++i) {
    window->show(Scene(), WindowValues());
    for (const HeadsetPose& pose : window->headsets()) {
      ++heard;
      EXPECT_EQ(pose.wearer, -1);
    }
  }
  EXPECT_EQ(heard, 1);
}

/// A window whose eyes take their time.
class SlowEyes final : public Window {
 public:
  explicit SlowEyes(Window window) : Window(std::move(window)) {}
  /// @param longest  that a picture may take [s] @return the quality after so many pictures
  RenderQuality after(int count, double seconds, double longest) {
    RenderQuality quality = RenderQuality::kHigh;
    drawFor(
        [&](Renderer& renderer, const Scene&, const SceneOptions&) {
          quality = renderer.quality();
          std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
          return true;
        },
        longest);
    for (int i = 0; i < count; ++i) show(Scene(), WindowValues());
    return quality;
  }
};

// Pictures of 30 ms are fast enough for a window, and too slow for a headset of 90 Hz.
TEST(UnseenWindow, TheQualityStepsDownToHoldTheHeadsetsRate) {
  std::vector<std::string> said;
  Result<Window> window = Window::createUnseen([&](const std::string& sentence) { said.push_back(sentence); });
  if (!window) GTEST_SKIP() << window.error().message;
  SlowEyes eyes(std::move(*window));
  EXPECT_TRUE(eyes.open());
  EXPECT_EQ(eyes.after(60, 0.03, 100.0), RenderQuality::kHigh);
  EXPECT_EQ(eyes.after(100, 0.03, 0.8 / 90.0), RenderQuality::kLow);
  ASSERT_FALSE(said.empty());
  EXPECT_NE(said.front().find("quality set to medium"), std::string::npos) << said.front();
}

}  // namespace
}  // namespace lorica::test
