#include "player/follow_camera.h"

#include "capture/files/joint_csv.h"
#include "session/treated_source.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/session/small_session.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace lorica {
namespace {

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
      FollowCamera camera = test::valueOf(FollowCamera::create({}, width, height));
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

TEST(FollowCamera, KeepsItsHeightAndDistanceForABodyThatStands) {
  Session session = walkingSession(1.0);
  const double height = session.character().height;
  FollowCamera camera = test::valueOf(FollowCamera::create({}, 1280, 720));
  while (*session.step()) {
    camera.update(session, 1.0 / 30.0);
    EXPECT_EQ(camera.camera().target.y(), 0.54 * height);
    EXPECT_NEAR((camera.camera().eye - camera.camera().target).norm(), 2.29 * height, 1e-12);
  }
}

}  // namespace
}  // namespace lorica
