#include "viewer/vr/headset_place.h"

#include "viewer/pictures/image_files.h"
#include "viewer/renderer/frame_setup.h"
#include "viewer/vr/headset_panel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace lorica {
namespace {

Isometry3 pose(const Vec3& at, double yaw, double pitch = 0.0, double roll = 0.0) {
  return Eigen::Translation3d(at) * Eigen::AngleAxisd(yaw, Vec3::UnitY()) * Eigen::AngleAxisd(pitch, Vec3::UnitX()) *
         Eigen::AngleAxisd(roll, Vec3::UnitZ());
}

Vec3 clip(const Camera& camera, const Vec3& p, int width, int height) {
  const FrameSetup setup = setUpFrame({}, {}, camera, width, height, 256);
  const Eigen::Vector4f c = setup.uniforms.clipFromWorld * Eigen::Vector4f(p.cast<float>().homogeneous());
  return (c.head<3>() / c.w()).cast<double>();
}

TEST(CameraOfAnEye, EdgesAreAtTheAnglesWhateverThePicturesShape) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> angle(0.3, 1.1), turn(-1.2, 1.2);
  for (int i = 0; i < 50; ++i) {
    const EyeAngles angles{-angle(random), angle(random), angle(random), -angle(random)};
    const Isometry3 eye = pose({turn(random), 1.6, turn(random)}, turn(random), turn(random), turn(random));
    const Camera camera = cameraOf(eye, angles, 0.05);
    for (const double across : {std::tan(angles.left), std::tan(angles.right)}) {
      for (const double upward : {std::tan(angles.down), std::tan(angles.up)}) {
        const Vec3 corner = clip(camera, eye * Vec3(3.0 * across, 3.0 * upward, -3.0), 320, 240);
        EXPECT_NEAR(corner.x(), across < 0.0 ? -1.0 : 1.0, 1e-4) << i;
        EXPECT_NEAR(corner.y(), upward < 0.0 ? -1.0 : 1.0, 1e-4) << i;
      }
    }
  }
}

TEST(CameraOfAnEye, ParallaxIsThatOfSimilarTriangles) {
  const double apart = 0.064, away = 2.0;
  const EyeAngles angles{-0.7, 0.7, 0.6, -0.6};
  double x[2];
  for (const int index : {0, 1}) {
    const Isometry3 eye = pose({apart * (index - 0.5), 1.6, 0.0}, 0.0);
    x[index] = clip(cameraOf(eye, angles, 0.05), {0.0, 1.6, -away}, 320, 240).x();
  }
  EXPECT_NEAR(x[0] - x[1], apart / away / std::tan(0.7), 1e-6);
}

TEST(CameraOfAnEye, WhatIsNearerThanTheNearestIsCut) {
  const Camera camera = cameraOf(pose({0, 1, 0}, 0.0), {}, 0.2);
  EXPECT_LT(clip(camera, {0, 1, -0.19}, 100, 100).z(), -1.0);
  EXPECT_GT(clip(camera, {0, 1, -0.21}, 100, 100).z(), -1.0);
}

TEST(HeadsetPlace, StandingBringsTheHeadThereAndLooksAhead) {
  const Isometry3 head = pose({0.4, 1.7, -0.8}, 2.1, 0.3, 0.1);
  HeadsetPlace place;
  place.stand(head, {3.0, 0.9, -2.0}, {1.0, 0.4, 0.0});
  const Isometry3 there = place.worldFromStage() * head;
  EXPECT_TRUE(there.translation().isApprox(Vec3(3.0, 1.7, -2.0), 1e-9)) << there.translation().transpose();
  Vec3 forward = -there.linear().col(2);
  EXPECT_NEAR(forward.y(), -head.linear().col(2).y(), 1e-9) << "the head stays as far up or down";
  forward.y() = 0.0;
  EXPECT_TRUE(forward.normalized().isApprox(Vec3::UnitX(), 1e-9));
  EXPECT_NEAR(place.worldFromStage().translation().y(), 0.0, 1e-12) << "the floors are one";
}

TEST(HeadsetPlace, InsideTheHeadIsAtTheEyesAndTurnsFreely) {
  HeadsetPlace place;
  place.stand(pose({0, 1.7, 0}, 0.0), Vec3::Zero(), Vec3::UnitZ());
  const Mat3 turned = place.worldFromStage().linear();
  const Isometry3 head = pose({0.2, 1.5, 0.1}, 0.7, -0.2);
  place.inside(head, {0.5, 1.62, 0.3});
  EXPECT_TRUE((place.worldFromStage() * head).translation().isApprox(Vec3(0.5, 1.62, 0.3), 1e-12));
  EXPECT_TRUE(place.worldFromStage().linear().isApprox(turned, 1e-12));
}

TEST(HeadsetPlace, InsideTheWearerWalksOnWhileTheAvatarStandsStill) {
  const Isometry3 followed = pose({1.0, 0.0, -2.0}, 0.8);
  const Vec3 off(0.02, -0.1, 0.01);  // a smaller avatar
  const auto eyes = [&](const HeadsetPlace& place, const Isometry3& head) {
    return Vec3((place.worldFromStage() * head).translation());
  };
  HeadsetPlace place;
  Isometry3 head = pose({0.1, 1.7, 0.2}, 0.3);
  Vec3 avatar = followed * head.translation() + off;
  place.along(followed, followed * head.translation(), avatar);
  EXPECT_TRUE(eyes(place, head).isApprox(avatar, 1e-12));
  head.translation() += Vec3(0.4, 0.05, 0.3);  // no image shows it
  place.along(followed, followed * head.translation(), avatar);
  EXPECT_TRUE(eyes(place, head).isApprox(avatar + followed.linear() * Vec3(0.4, 0.05, 0.3), 1e-12));
  // The avatar comes after: the eyes stay where they are.
  avatar = followed * head.translation() + off;
  const Vec3 before = eyes(place, head);
  place.along(followed, followed * head.translation(), avatar);
  EXPECT_TRUE(eyes(place, head).isApprox(before, 1e-12));
  // Another avatar has other proportions.
  place.forgetAvatar();
  place.along(followed, followed * head.translation(), avatar + Vec3(0.0, 0.3, 0.0));
  EXPECT_TRUE(eyes(place, head).isApprox(avatar + Vec3(0.0, 0.3, 0.0), 1e-12));
}

TEST(HeadsetPlace, WalksWhereTheHeadLooks) {
  const Isometry3 head = pose({0.3, 1.6, 0.2}, 0.5 * std::numbers::pi, -0.6);  // to -X, and down
  HeadsetPlace place;
  place.walk(head, {0.0, 1.0}, 0.5);
  EXPECT_TRUE(place.worldFromStage().translation().isApprox(Vec3(-0.5 * HeadsetPlace::kWalk, 0.0, 0.0), 1e-9));
  place.walk(head, {1.0, 0.0}, 0.5);
  EXPECT_NEAR(place.worldFromStage().translation().z(), -0.5 * HeadsetPlace::kWalk, 1e-9) << "its right is -Z";
}

TEST(HeadsetPlace, TurnsAroundTheHead) {
  const Isometry3 head = pose({1.3, 1.6, -0.7}, 0.4);
  HeadsetPlace place;
  place.stand(head, {2.0, 0.0, 1.0}, -Vec3::UnitZ());
  place.turn(head, 0.5 * std::numbers::pi);
  const Isometry3 there = place.worldFromStage() * head;
  EXPECT_TRUE(there.translation().isApprox(Vec3(2.0, 1.6, 1.0), 1e-9));
  EXPECT_TRUE((-there.linear().col(2)).isApprox(Vec3(-1.0, 0.0, 0.0), 1e-9)) << "from -Z to the left";
}

class HeadsetPanels : public ::testing::Test {
 protected:
  void SetUp() override {
    head.translation() = Vec3(0.4, 1.7, -0.3);
    head.linear() = Eigen::AngleAxisd(0.8, Vec3::UnitY()).toRotationMatrix();
    panel.open(head);
    list();
    EXPECT_TRUE(panel.draw(controls, std::nullopt));
  }
  /// A ray from the right hand to a point of the panel: -1 to 1 to the right and up.
  [[nodiscard]] Ray to(double x, double y) const {
    const Vec3 at = panel.stageFromPanel() * Vec3(0.5 * x * panel.width(), 0.5 * y * panel.height(), 0.0);
    const Vec3 hand = head * Vec3(0.3, -0.4, -0.2);
    return {hand, at - hand};
  }

  /// As a run has them that has scenes.
  void list() {
    listChoices(choices, controls);
    controls.offer(ControlId::kScene).choices = scenes;
    controls.offer(ControlId::kRestart);
  }
  /// The row of a control.
  [[nodiscard]] std::size_t rowOf(ControlId id) const {
    std::size_t row = 0;
    while (row < panel.rowCount() && panel.controlOf(row) != id) ++row;
    return row;
  }

  Isometry3 head = Isometry3::Identity();
  HeadsetPanel panel;
  std::vector<std::string> scenes = {"boxes", "pool"};
  Controls controls;
  Choices choices;
};

TEST_F(HeadsetPanels, OpensAheadAndFacesTheWearer) {
  const Vec3 at = panel.stageFromPanel().translation() - head.translation();
  const Vec3 ahead = head.linear() * Vec3(0.0, 0.0, -1.0);
  EXPECT_NEAR(Vec3(at.x(), 0.0, at.z()).normalized().dot(ahead), 1.0, 1e-9);
  EXPECT_NEAR(panel.stageFromPanel().linear().col(2).dot(ahead), -1.0, 1e-9);
  EXPECT_GT(panel.width(), 0.2);
  EXPECT_LT(panel.width(), 0.7);
}

TEST_F(HeadsetPanels, ARayMeetsTheRowThatItPointsAt) {
  for (std::size_t row = 0; row < panel.rowCount(); ++row) {
    const double y = 1.0 - (2.0 * static_cast<double>(row) + 1.0) / static_cast<double>(panel.rowCount());
    EXPECT_EQ(panel.rowAt(to(0.2, y)), row);
  }
  EXPECT_FALSE(panel.rowAt(to(1.02, 0.0)));
  EXPECT_FALSE(panel.rowAt(to(0.0, -1.02)));
  const Ray ray = to(0.0, 0.0);
  EXPECT_FALSE(panel.rowAt({ray.origin, -ray.direction}));
  EXPECT_FALSE(panel.rowAt({ray.origin + 2.0 * ray.direction, -ray.direction})) << "from behind";
  panel.close();
  EXPECT_FALSE(panel.rowAt(ray));
}

TEST_F(HeadsetPanels, IsDrawnAgainOnlyIfItSaysSomethingElse) {
  EXPECT_FALSE(panel.draw(controls, std::nullopt));
  const Image before = panel.image();
  EXPECT_TRUE(panel.draw(controls, rowOf(ControlId::kHulls)));
  EXPECT_NE(panel.image().rgba, before.rgba);
  if (const char* to = std::getenv("LORICA_VR_PICTURES")) {
    EXPECT_TRUE(writePng(std::string(to) + "/panel.png", panel.image()));
  }
  EXPECT_EQ(panel.image().height, before.height);
  choices.paused = true;
  list();
  EXPECT_TRUE(panel.draw(controls, rowOf(ControlId::kHulls)));
}

TEST_F(HeadsetPanels, CutsNamesBetweenCharacters) {
  // Half a character would be drawn as a sign of its own: 5 of 3 bytes are less than 16 bytes, 6 are more.
  scenes = {"身長身長身長身長", "pool"};
  list();
  controls[ControlId::kScene].value = 0.0;
  HeadsetPanel cut;
  cut.open(head);
  EXPECT_TRUE(cut.draw(controls, std::nullopt));
  scenes[0] = "身長身長身";
  list();
  controls[ControlId::kScene].value = 0.0;
  HeadsetPanel whole;
  whole.open(head);
  EXPECT_TRUE(whole.draw(controls, std::nullopt));
  EXPECT_EQ(whole.image().rgba, cut.image().rgba);
}

TEST_F(HeadsetPanels, HasTheControlsThatAreThere) {
  for (const ControlId id :
       {ControlId::kPause, ControlId::kRestart, ControlId::kScene, ControlId::kHulls, ControlId::kInside}) {
    EXPECT_LT(rowOf(id), panel.toAvatarRow()) << static_cast<int>(id);
  }
  EXPECT_EQ(rowOf(ControlId::kFindCamera), panel.rowCount()) << "there is no run that has a camera";
  EXPECT_FALSE(panel.controlOf(panel.toAvatarRow()) || panel.controlOf(panel.closeRow()));
  controls[ControlId::kScene].absent = true;
  EXPECT_TRUE(panel.draw(controls, std::nullopt));
  EXPECT_EQ(rowOf(ControlId::kScene), panel.rowCount());
}

}  // namespace
}  // namespace lorica
