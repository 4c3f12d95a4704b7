#include "session/session.h"

#include "acd/decompose.h"
#include "capture/files/joint_csv.h"
#include "collision/hulls/keyframes.h"
#include "collision/live/choose_cover.h"
#include "session/pose_source.h"
#include "session/scenes/demo_scene.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/capture/spoiled_legs.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace lorica {
namespace {

using J = BodyJoint;

std::vector<SkeletonFrame> punches() {
  return shippedFrames("punch_and_kick");
}

/// Eight parts of the mannequin from its bind pose, quick to make.
const Decomposition& eightParts() {
  static const Decomposition result = [] {
    const Character character = makeMannequin();
    DecomposeSettings settings;
    settings.maxParts = 8;
    const PoseView bindPose{character.mesh.vertices, static_cast<int>(character.mesh.vertices.size())};
    Result<Decomposition> made = decompose(character.mesh, bindPose, settings);
    EXPECT_TRUE(made.ok()) << made.error().message;
    return std::move(made).value();
  }();
  return result;
}

std::unique_ptr<PoseSource> performed(std::vector<SkeletonFrame> frames) {
  return makeJointPoseSource(makeMannequin().skeleton, makeRecordedSource(std::move(frames))).value();
}

Session makeSession(std::vector<SkeletonFrame> frames, World world = makeDemoWorld(7)) {
  Result<Session> session =
      Session::create(makeMannequin(), eightParts(), performed(std::move(frames)), std::move(world));
  LORICA_CHECK(session.ok(), "the mannequin fits its own decomposition");
  return std::move(session).value();
}

TEST(Session, RunsARecordingToItsEndAndThePersonTouchesProps) {
  const std::vector<SkeletonFrame> frames = punches();
  Session session = makeSession(frames);
  std::size_t contactCount = 0;
  std::set<int> propsTouched;
  while (true) {
    const bool more = test::valueOf(session.step());
    if (!more) break;
    contactCount += session.world().contacts().size();
    for (const Contact& contact : session.world().contacts()) propsTouched.insert(contact.prop);
    for (const LivePart& part : session.body().parts()) {
      EXPECT_FALSE(part.shape.degenerate());
      EXPECT_LT(boundsOf(part.shape.vertices).center().norm(), 0.6);
    }
    for (const Prop& prop : session.world().props()) ASSERT_TRUE(prop.worldFromProp.matrix().allFinite());
    EXPECT_GE(session.times().total(), 0.0);
  }
  EXPECT_EQ(session.frameCount(), static_cast<int>(frames.size()));
  EXPECT_GE(propsTouched.size(), 5u);
  EXPECT_GE(contactCount, propsTouched.size());
}

TEST(Session, HullsContainThePosedMesh) {
  std::vector<SkeletonFrame> frames = punches();
  frames.resize(40);
  Session session = makeSession(frames);
  while (*session.step()) {
    for (std::size_t i = 0; i < session.body().parts().size(); ++i) {
      std::vector<Vec3> points;
      for (PointIndex p : session.body().decomposition().parts[i].points) {
        points.push_back(session.points()[p]);
      }
      EXPECT_LT(largestViolation(worldHull(session.body().parts()[i]), points), 1e-6 * session.character().height);
    }
  }
}

TEST(Session, TwoRunsGiveTheSameHashAndTheSamePropsBitForBit) {
  std::vector<SkeletonFrame> frames = punches();
  frames.resize(90);
  Session first = makeSession(frames);
  Session second = makeSession(frames);
  std::uint64_t before = first.hash();
  while (*first.step()) {
    ASSERT_TRUE(*second.step());
    EXPECT_NE(first.hash(), before) << "the hash changes with every frame";
    before = first.hash();
    EXPECT_EQ(first.hash(), second.hash());
    for (std::size_t i = 0; i < first.world().props().size(); ++i) {
      ASSERT_EQ(first.world().props()[i].worldFromProp.matrix(), second.world().props()[i].worldFromProp.matrix());
    }
  }
  frames.back()[BodyJoint::kLeftHand].position.y() += 0.01;
  Session other = makeSession(frames);
  while (*other.step()) continue;
  EXPECT_NE(other.hash(), first.hash()) << "a hand one centimetre higher in the last frame changes the hash";
}

TEST(Session, PropsDoNotChangeTheHulls) {
  std::vector<SkeletonFrame> frames = punches();
  frames.resize(30);
  Session manyProps = makeSession(frames);
  Session alone = makeSession(frames, World());
  while (*manyProps.step()) ASSERT_TRUE(*alone.step());
  EXPECT_EQ(manyProps.hashes().hulls, alone.hashes().hulls);
}

TEST(Session, FrameTimesMoveThePropsBoundedly) {
  // A pause of ten seconds and a repeated time: physics advances by 0.1 s and 0.001 s.
  std::vector<SkeletonFrame> frames(3, punches().front());
  frames[1].time = frames[0].time + 10.0;
  frames[2].time = frames[1].time;
  World world;
  Prop prop;
  prop.worldFromProp.translation() = Vec3(20.0, 30.0, 0.0);
  world.addProp(prop);
  Session session = makeSession(frames, std::move(world));
  double seconds = 0.0;
  for (double expected : {1.0 / 30.0, 0.1, 0.001}) {
    ASSERT_TRUE(*session.step());
    seconds += expected;
    EXPECT_NEAR(session.world().props()[0].velocity.y(), -9.81 * seconds, 1e-4);
  }
}

TEST(Session, ADecompositionOfAnotherMeshIsRefusedWithASentence) {
  Decomposition other = eightParts();
  other.vertexCount += 1;
  const Error session = test::errorOf(Session::create(makeMannequin(), other, performed(punches()), World()));
  EXPECT_EQ(session.code, ErrorCode::kInvalidArgument);
  EXPECT_TRUE(test::has(session.message, std::to_string(other.vertexCount)));
  other = eightParts();
  other.triangleCount -= 2;
  EXPECT_FALSE(Session::create(makeMannequin(), other, performed(punches()), World()).ok());
}

/// The bone transforms of a session in each of these frames.
std::vector<Affine3> bonesOf(const std::vector<SkeletonFrame>& frames) {
  Session session = makeSession(frames, World());
  std::vector<Affine3> bones;
  while (*session.step()) {
    for (std::size_t j = 0; j < session.worldFromJoint().size(); ++j) {
      bones.push_back(session.worldFromJoint()[j] * session.character().jointFromModel[j]);
    }
  }
  return bones;
}

TEST(Session, HullsOfAFewPointsHoldThePosedMeshInTheFramesThatTheyWereChosenIn) {
  std::vector<SkeletonFrame> frames = punches();
  frames.resize(200);
  for (std::size_t i = 0; i < 20; ++i) frames[i] = frames[10 * i];
  frames.resize(20);
  const Character character = makeMannequin();
  const std::vector<Affine3> bones = bonesOf(frames);
  CoverSettings settings;
  settings.maxHullVertices = 40;
  const HullCover cover = test::valueOf(chooseCover(eightParts(), liftPoints(character, eightParts()),
                                                    {bones, character.skeleton.jointCount()}, {}, settings));
  Session session = test::valueOf(Session::create(character, eightParts(), performed(frames), World(), cover));
  EXPECT_EQ(session.body().coverage().maxHullVertices, 40);
  EXPECT_EQ(session.body().coverage().growth, cover.growth);
  int looked = 0;
  while (*session.step()) {
    for (std::size_t i = 0; i < session.body().parts().size(); ++i) {
      const LivePart& part = session.body().parts()[i];
      EXPECT_LE(part.shape.vertices.size(), 40u);
      std::vector<Vec3> points;
      for (PointIndex p : eightParts().parts[i].points) {
        points.push_back(session.points()[p]);
      }
      EXPECT_LT(largestViolation(worldHull(part), points), 1e-5 * character.height) << "part " << i;
      ++looked;
    }
  }
  EXPECT_EQ(looked, 20 * 8);
}

TEST(Session, TrainingDistanceIsThatOfTheSkinnedMesh) {
  std::vector<SkeletonFrame> frames = punches();
  const Character character = makeMannequin();
  const std::vector<SkeletalMotion> motions = {perform(character.skeleton, frames).value()};
  const std::vector<Vec3> keyframes = test::valueOf(sampleKeyframes(character, motions, 2));
  TrainingRange range =
      trainingRange(eightParts(), PoseView{keyframes, static_cast<int>(character.mesh.vertices.size())});
  range.knownDistance = 0.05;
  Session session =
      test::valueOf(Session::create(character, eightParts(), performed(frames), World(), std::nullopt, range));
  EXPECT_FALSE(session.trainingDistance().has_value()) << "there is no pose yet";
  EXPECT_FALSE(session.outsideKnownRange());
  std::vector<Vec3> probes(range.probes.size());
  int outside = 0;
  while (*session.step()) {
    gatherProbes(range, session.points(), probes);
    const double expected = trainingDistance(range, probes);
    ASSERT_TRUE(session.trainingDistance().has_value());
    EXPECT_NEAR(*session.trainingDistance(), expected, 1.1e-6);  // computed in steps of a micrometre
    if (std::abs(expected - 0.05) > 1e-5) {
      EXPECT_EQ(session.outsideKnownRange(), expected > 0.05);
    }
    outside += session.outsideKnownRange() ? 1 : 0;
    // The first and the last frame are the keyframes.
    if (session.frameCount() == 1 || session.frameCount() == static_cast<int>(frames.size())) {
      EXPECT_LT(*session.trainingDistance(), 2e-6);
    }
  }
  EXPECT_GT(outside, 10) << "kicks are distant from standing";
  EXPECT_LT(outside, session.frameCount());
  Session without = makeSession(frames);
  ASSERT_TRUE(*without.step());
  EXPECT_FALSE(without.trainingDistance().has_value());
}

TEST(Session, CoverAndTrainingOfAnotherDecompositionAreRefusedWithASentence) {
  const Character character = makeMannequin();
  const HullCover fine = coverExactly(eightParts(), liftPoints(character, eightParts()));
  const auto sentence = [&](std::optional<HullCover> cover, std::optional<TrainingRange> training) {
    const Result<Session> session =
        Session::create(character, eightParts(), performed(punches()), World(), std::move(cover), std::move(training));
    return session.ok() ? std::string() : session.error().message;
  };
  EXPECT_EQ(sentence(fine, std::nullopt), "");
  HullCover other = fine;
  other.points.pop_back();
  EXPECT_EQ(sentence(other, std::nullopt), "the hull cover lists the points of 7 parts, expected 8");
  other = fine;
  other.points[3].clear();
  EXPECT_EQ(sentence(other, std::nullopt), "the hull cover has no points of part 3");
  other = fine;
  other.points[2][0].point = eightParts().pointCount();
  EXPECT_TRUE(test::has(sentence(other, std::nullopt), "part 2"));

  const PoseView bindPose{character.mesh.vertices, static_cast<int>(character.mesh.vertices.size())};
  TrainingRange range = trainingRange(eightParts(), bindPose);
  EXPECT_EQ(sentence(std::nullopt, range), "");
  range.probes[1] = -1;
  EXPECT_TRUE(test::has(sentence(std::nullopt, range), "point -1"));
  range.probes.pop_back();
  EXPECT_TRUE(test::has(sentence(std::nullopt, range), "probes"));
}

TEST(Session, WhatTheSourceComplainsAboutIsHandedOn) {
  class BadSource : public SkeletonSource {
   public:
    Result<std::optional<SkeletonFrame>> next() override { return Error{ErrorCode::kBadFormat, "line 7 is damaged"}; }
  };
  Session session = test::valueOf(
      Session::create(makeMannequin(), eightParts(),
                      makeJointPoseSource(makeMannequin().skeleton, std::make_unique<BadSource>()).value(), World()));
  EXPECT_EQ(test::errorOf(session.step()).message, "line 7 is damaged");
  EXPECT_EQ(session.frameCount(), 0);
}

// Whatever a sensor says of somebody's legs, the avatar stands on the floor.

const Character& mannequin() {
  static const Character character = makeMannequin();
  return character;
}

/// Largest height of the avatar's lowest point above or below the floor from `seconds` on [m].
double floats(const std::vector<SkeletonFrame>& frames, double seconds, const JointSettings& settings = {}) {
  const Result<SkeletalMotion> motion = perform(mannequin(), frames, settings);
  EXPECT_TRUE(motion) << motion.error().message;
  double worst = 0.0;
  std::vector<Affine3> world(static_cast<std::size_t>(mannequin().skeleton.jointCount()));
  std::vector<Vec3> posed(mannequin().mesh.vertices.size());
  for (int f = 0; f < motion->frameCount(); f += 5) {
    if (motion->times[f] - motion->times.front() < seconds) continue;
    computeWorldFromJoint(mannequin().skeleton, motion->pose(f), world);
    computeWorldFromModel(mannequin(), world, world);
    skinLinearBlend(mannequin(), world, posed);
    double lowest = posed.front().y();
    for (const Vec3& p : posed) lowest = std::min(lowest, p.y());
    worst = std::max(worst, std::abs(lowest));
  }
  return worst;
}

TEST(Standing, LegsThatRunUpwards) {
  std::vector<SkeletonFrame> frames = shippedFrames("wave");
  for (SkeletonFrame& frame : frames) {
    test::turnUpwards(frame);
    for (TrackedJoint& joint : frame.joints) joint.position.y() += 0.5;
  }
  EXPECT_LT(floats(frames, 2.5), 0.03);
}

TEST(Standing, LegsThatChangeTheirLength) {
  std::vector<SkeletonFrame> frames = shippedFrames("wave");
  for (std::size_t f = 0; f < frames.size(); ++f) {
    test::scaleThighs(frames[f], 1.0 + 0.7 * std::sin(1.3 * static_cast<double>(f)));
    for (const auto& leg : test::kLegs) frames[f][leg.foot].confidence = frames[f][leg.knee].confidence = 0.5;
  }
  EXPECT_LT(floats(frames, 3.0), 0.03);
}

TEST(Standing, SomebodyOnAChair) {
  std::vector<SkeletonFrame> frames = shippedFrames("wave");
  for (SkeletonFrame& frame : frames) {
    for (const J joint : {J::kLeftKnee, J::kRightKnee, J::kLeftFoot, J::kRightFoot}) frame[joint] = {};
    for (TrackedJoint& joint : frame.joints) joint.position.y() -= 0.4;
  }
  EXPECT_LT(floats(frames, 2.5), 0.03);
  JointSettings upper;
  upper.upperBody = true;
  EXPECT_LT(floats(frames, 0.0, upper), 0.03);
}

TEST(Standing, AWebcamThatSeesNoHips) {
  std::vector<SkeletonFrame> frames = shippedFrames("wave");
  for (SkeletonFrame& frame : frames) {
    for (const J joint : {J::kLeftHip, J::kRightHip, J::kLeftKnee, J::kRightKnee, J::kLeftFoot, J::kRightFoot}) {
      frame[joint] = {};
    }
  }
  JointSettings upper;
  upper.upperBody = true;
  EXPECT_LT(floats(frames, 0.0, upper), 0.03);
}

/// Half the extents of a prop's axis-aligned bounds in its current orientation.
Vec3 halfBounds(const Prop& prop) {
  if (prop.shape == PropShape::kSphere) return Vec3::Constant(prop.halfExtents.x());
  return prop.worldFromProp.linear().cwiseAbs() * prop.halfExtents;
}

bool overlaps(const Prop& prop, const Vec3& min, const Vec3& max) {
  const Vec3 center = prop.worldFromProp.translation();
  const Vec3 half = halfBounds(prop);
  return ((center + half).array() > min.array()).all() && ((center - half).array() < max.array()).all();
}

TEST(DemoScene, NothingStartsWhereThePersonStandsOrInTheFloorOrInAnotherProp) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const World world = makeDemoWorld(seed);
    EXPECT_NEAR(static_cast<double>(world.props().size()), 20.0, 4.0);
    for (std::size_t i = 0; i < world.props().size(); ++i) {
      const Prop& prop = world.props()[i];
      const Vec3 center = prop.worldFromProp.translation();
      const Vec3 half = halfBounds(prop);
      EXPECT_FALSE(overlaps(prop, Vec3(-0.45, 0.0, -0.45), Vec3(0.45, 1.9, 0.45))) << "trunk, prop " << i;
      EXPECT_FALSE(overlaps(prop, Vec3(-0.95, 1.2, -0.15), Vec3(0.95, 1.6, 0.15))) << "arms, prop " << i;
      EXPECT_GT(center.y() - half.y(), -1e-6);
      EXPECT_LT(center.y(), 7.0);
      EXPECT_LT(std::hypot(center.x(), center.z()), 1.0);
      for (std::size_t k = 0; k < i; ++k) {
        // Bounds of neighbours in a tower touch; a rounding error of a micrometre does not count as overlap.
        const Prop& other = world.props()[k];
        const Vec3 otherHalf = halfBounds(other) - Vec3::Constant(1e-6);
        const Vec3 otherCenter = other.worldFromProp.translation();
        EXPECT_FALSE(overlaps(prop, otherCenter - otherHalf, otherCenter + otherHalf)) << i << " and " << k;
      }
    }
  }
}

TEST(DemoScene, PropsSuitThePersonTheyAreMadeFor) {
  const World usual = makeDemoWorld(4), large = makeDemoWorldUnder(World::Settings().gravity, 4, 1.5);
  ASSERT_EQ(usual.props().size(), large.props().size());
  for (std::size_t i = 0; i < usual.props().size(); ++i) {
    const Prop &one = usual.props()[i], &other = large.props()[i];
    EXPECT_EQ(other.halfExtents, 1.5 * one.halfExtents);
    EXPECT_EQ(other.worldFromProp.translation(), 1.5 * one.worldFromProp.translation());
    EXPECT_NEAR(other.mass, 3.375 * one.mass, 1e-12) << "as dense";
  }
}

TEST(DemoScene, TheSameSeedGivesTheSameWorldAndAnotherGivesAnother) {
  const World a = makeDemoWorld(1), b = makeDemoWorld(1), c = makeDemoWorld(2);
  bool differs = false;
  ASSERT_EQ(a.props().size(), b.props().size());
  for (std::size_t i = 0; i < a.props().size(); ++i) {
    EXPECT_EQ(a.props()[i].worldFromProp.matrix(), b.props()[i].worldFromProp.matrix());
    EXPECT_EQ(a.props()[i].halfExtents, b.props()[i].halfExtents);
    differs = differs || a.props()[i].halfExtents != c.props()[i].halfExtents;
  }
  EXPECT_TRUE(differs);
}

TEST(DemoScene, TheTowersStandUntilTheyAreKnocked) {
  const World demo = makeDemoWorld(1);
  World world;
  for (const Prop& prop : demo.props()) {
    // Falling props start higher than 2 m.
    if (prop.worldFromProp.translation().y() < 2.0) world.addProp(prop);
  }
  ASSERT_EQ(world.props().size(), 10u);
  const std::vector<Prop> before(world.props().begin(), world.props().end());
  for (int i = 0; i < 300; ++i) world.step({}, 1.0 / 30.0);
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_LT((world.props()[i].worldFromProp.translation() - before[i].worldFromProp.translation()).norm(), 0.01);
  }
}

TEST(DemoScene, EverythingIsDownAfterThreeSeconds) {
  World world = makeDemoWorld(3);
  for (int i = 0; i < 90; ++i) world.step({}, 1.0 / 30.0);
  for (const Prop& prop : world.props()) EXPECT_LT(prop.worldFromProp.translation().y(), 1.4);
}

}  // namespace
}  // namespace lorica
