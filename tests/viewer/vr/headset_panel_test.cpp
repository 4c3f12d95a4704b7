#include "viewer/vr/headset_panel.h"

#include "viewer/pictures/image_files.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

namespace lorica {
namespace {

using Row = HeadsetPanel::Row;

class HeadsetPanels : public ::testing::Test {
 protected:
  void SetUp() override {
    head.translation() = Vec3(0.4, 1.7, -0.3);
    head.linear() = Eigen::AngleAxisd(0.8, Vec3::UnitY()).toRotationMatrix();
    panel.open(head);
    EXPECT_TRUE(panel.draw(values, choices, std::nullopt));
  }
  /// A ray from the right hand to a point of the panel: -1 to 1 to the right and up.
  [[nodiscard]] Ray to(double x, double y) const {
    const Vec3 at = panel.stageFromPanel() * Vec3(0.5 * x * panel.width(), 0.5 * y * panel.height(), 0.0);
    const Vec3 hand = head * Vec3(0.3, -0.4, -0.2);
    return {hand, at - hand};
  }

  Isometry3 head = Isometry3::Identity();
  HeadsetPanel panel;
  WindowValues values;
  WindowChoices choices;
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
  for (int row = 0; row < HeadsetPanel::kRows; ++row) {
    const double y = 1.0 - (2.0 * row + 1.0) / HeadsetPanel::kRows;
    EXPECT_EQ(panel.rowAt(to(0.2, y)), Row(row));
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
  EXPECT_FALSE(panel.draw(values, choices, std::nullopt));
  const Image before = panel.image();
  EXPECT_TRUE(panel.draw(values, choices, Row::kHulls));
  EXPECT_NE(panel.image().rgba, before.rgba);
  if (const char* to = std::getenv("LORICA_VR_PICTURES")) {
    EXPECT_TRUE(writePng(std::string(to) + "/panel.png", panel.image()));
  }
  EXPECT_EQ(panel.image().height, before.height);
  choices.paused = true;
  EXPECT_TRUE(panel.draw(values, choices, Row::kHulls));
}

TEST_F(HeadsetPanels, RowsChooseAndAsk) {
  WindowRequests requests;
  const std::vector<std::string> scenes = {"boxes", "pool"};
  HeadsetPanel::choose(Row::kScene, values, choices, requests);
  EXPECT_FALSE(requests.scene) << "there are none";
  values.scenes = scenes;
  values.scene = 1;
  HeadsetPanel::choose(Row::kScene, values, choices, requests);
  EXPECT_EQ(requests.scene, 0);
  HeadsetPanel::choose(Row::kRestart, values, choices, requests);
  EXPECT_EQ(requests.seekTo, 0.0);
  HeadsetPanel::choose(Row::kFindCamera, values, choices, requests);
  EXPECT_TRUE(requests.findCamera);
  const WindowChoices before = choices;
  for (const Row row : {Row::kPause, Row::kHulls, Row::kInside}) HeadsetPanel::choose(row, values, choices, requests);
  EXPECT_NE(choices.paused, before.paused);
  EXPECT_NE(choices.show.hulls, before.show.hulls);
  EXPECT_NE(choices.inside, before.inside);
}

}  // namespace
}  // namespace lorica
