#include "session/contact_events.h"

#include "acd/decompose.h"
#include "capture/files/joint_csv.h"
#include "collision/live/live_body.h"
#include "geometry/mass_properties.h"
#include "session/contact_bones.h"
#include "session/pose_source.h"
#include "session/session.h"
#include "session/treated_source.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/session/haired_box.h"
#include "tests/session/small_session.h"
#include "tests/support/allocations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace lorica {
namespace {

constexpr double kFrame = 1.0 / 60.0;

/// The box stands still; its hair moves along x: how far from its place, for each frame [m].
Session swayingHair(const std::vector<double>& along) {
  SkeletalMotion motion =
      test::hairedBoxMotion(static_cast<int>(along.size()), [](double) { return JointTransform(); });
  const auto joints = static_cast<std::size_t>(motion.skeleton.jointCount());
  for (std::size_t frame = 0; frame < along.size(); ++frame) {
    motion.poses[frame * joints + 1].translation.x() += along[frame];
  }
  return Session::create(test::hairedBox(), test::hairedBoxParts(), makeMotionPoseSource(std::move(motion)), World())
      .value();
}

/// In steps of 0.03 m from its place into the box, stays there, and comes back.
std::vector<double> inAndOut() {
  std::vector<double> along{0.0, -0.03, -0.06, -0.09};
  along.resize(20, -0.09);
  along.insert(along.end(), {-0.06, -0.03});
  along.resize(40, 0.0);
  return along;
}

TEST(ContactEvents, TheMassesOfThePartsAddUpToTheBody) {
  const Session box = swayingHair({0.0});
  const ContactEvents ofBox(box);
  EXPECT_NEAR(ofBox.massOf(0), 160.0, 1e-9);
  EXPECT_NEAR(ofBox.massOf(1), 0.24, 1e-9);
  const Session mannequin = test::demoSession(makeMotionPoseSource({}));
  const ContactEvents events(mannequin);
  const TriMesh& mesh = mannequin.character().mesh;
  const double body = 1000.0 * massProperties(mesh.vertices, mesh.triangles).volume;
  double sum = 0.0;
  for (PartIndex part = 0; part < 8; ++part) sum += events.massOf(part);
  EXPECT_NEAR(sum, body, 1e-6 * body);
}

/// The hair's side is 4 cm from the box and moves by 3 cm per frame: they overlap from frame 2 to frame 20.
TEST(ContactEvents, AnOwnPartThatHitsTheBodyHasItsClosingSpeedTimesTheLighterMass) {
  Session session = swayingHair(inAndOut());
  ContactEvents events(session);
  std::vector<ContactEvent> all;
  std::vector<int> frames;
  for (int frame = 0; session.step().value(); ++frame) {
    for (const ContactEvent& event : events.update(session)) {
      all.push_back(event);
      frames.push_back(frame);
    }
  }
  ASSERT_EQ(frames.front(), 2);
  ASSERT_EQ(all.front().phase, ContactPhase::kBegin);
  const Touch& hit = all.front().touch;
  EXPECT_EQ(hit.pair, (TouchPair{TouchKind::kSelf, 0, 0, 0, 1}));
  EXPECT_EQ(session.character().skeleton.joint(hit.bone).name, "body");
  EXPECT_EQ(session.character().skeleton.joint(hit.otherBone).name.substr(0, 4), "hair");
  EXPECT_NEAR(hit.depth, 0.02, 3e-4);
  EXPECT_TRUE(hit.normal.isApprox(Vec3::UnitX(), 1e-2)) << hit.normal.transpose();
  EXPECT_NEAR(hit.strength, 0.03 / kFrame * 0.24, 0.01);
  EXPECT_GT(all[1].touch.strength, 0.4);          // moves deeper
  EXPECT_NEAR(all[4].touch.strength, 0.0, 1e-9);  // rests
  const auto leaving = static_cast<std::size_t>(20 - 2);
  ASSERT_EQ(frames[leaving], 20);
  EXPECT_EQ(all[leaving].touch.strength, 0.0);
  EXPECT_EQ(all.back().phase, ContactPhase::kEnd);
  EXPECT_NEAR(all.back().touched, 20 * kFrame, 1e-9);
  EXPECT_NEAR(all.back().time, 26 * kFrame, 1e-9);
  for (std::size_t i = 1; i + 1 < all.size(); ++i) EXPECT_EQ(all[i].phase, ContactPhase::kStay);
}

TEST(ContactEvents, APartThatLeavesForTwoFramesAtATimeBeginsOnce) {
  std::vector<double> along{0.0, -0.03, -0.06};
  for (int turn = 0; turn < 6; ++turn) along.insert(along.end(), {-0.06, -0.06, -0.03, -0.03});  // in, and out
  along.resize(40, 0.0);
  Session session = swayingHair(along);
  ContactEvents events(session);
  int begins = 0, ends = 0, raw = 0;
  bool before = false;
  while (session.step().value()) {
    for (const ContactEvent& event : events.update(session)) {
      begins += event.phase == ContactPhase::kBegin ? 1 : 0;
      ends += event.phase == ContactPhase::kEnd ? 1 : 0;
    }
    const bool touching = !session.selfContacts().empty();
    raw += touching && !before ? 1 : 0;
    before = touching;
  }
  EXPECT_EQ(raw, 6) << "what a user without events would count";
  EXPECT_EQ(begins, 1);
  EXPECT_EQ(ends, 1);
}

TEST(ContactEvents, APartThatJumpsStrikesNothing) {
  std::vector<double> along{0.0, 0.6, 0.6};  // 36 m/s away
  along.resize(6, -0.06);                    // and back, into the box
  Session session = swayingHair(along);
  ContactEvents events(session);
  bool began = false;
  while (session.step().value()) {
    for (const ContactEvent& event : events.update(session)) {
      began = began || event.phase == ContactPhase::kBegin;
      EXPECT_EQ(event.touch.strength, 0.0);
    }
  }
  EXPECT_TRUE(began);
}

/// A recorded kick and throw among the props of the demo, as the world reports it.
struct Kick {
  Session session = test::demoSession(
      makeTreatedSource(makeMannequin(), makeRecordedSource(test::shippedFrames("punch_and_kick", 400)), {}).value());
  ContactEvents events{session};
};

TEST(ContactEvents, StrengthOfPropsIsTheImpulseOfTheWorld) {
  Kick kick;
  int touched = 0;
  while (kick.session.step().value()) {
    std::map<std::pair<int, int>, double> impulses;
    for (const Contact& contact : kick.session.world().contacts()) {
      impulses[{contact.part, contact.prop}] += contact.impulse;
    }
    std::map<std::pair<int, int>, double> strengths;
    for (const ContactEvent& event : kick.events.update(kick.session)) {
      if (event.touch.pair.kind != TouchKind::kProp || event.touched < event.time) continue;
      EXPECT_EQ(event.touch.otherBone, kNoJoint);
      strengths[{event.touch.pair.part, event.touch.pair.other}] = event.touch.strength;
    }
    EXPECT_EQ(strengths, impulses);
    touched += static_cast<int>(impulses.size());
  }
  EXPECT_GT(touched, 20);
}

TEST(ContactEvents, EachContactBeginsOnceStaysInEachFrameAndEndsOnce) {
  Kick kick;
  std::map<TouchPair, double> open;      // began
  std::map<TouchPair, double> released;  // last touched
  int begins = 0, flickers = 0;
  std::set<TouchPair> before;  // raw contacts
  const auto take = [&](std::span<const ContactEvent> events) {
    std::set<TouchPair> seen;
    for (const ContactEvent& event : events) {
      const TouchPair& pair = event.touch.pair;
      EXPECT_TRUE(seen.insert(pair).second);
      if (event.phase == ContactPhase::kBegin) {
        EXPECT_TRUE(open.emplace(pair, event.time).second);
        if (const auto last = released.find(pair); last != released.end()) {
          EXPECT_GE(event.time - last->second, TouchTracker::kReleaseSeconds);
        }
        ++begins;
      } else {
        ASSERT_TRUE(open.contains(pair));
        EXPECT_EQ(open[pair], event.began);
        if (event.phase == ContactPhase::kEnd) {
          released[pair] = event.touched;
          open.erase(pair);
        }
      }
    }
    for (const auto& [pair, time] : open) EXPECT_TRUE(seen.contains(pair));
  };
  while (kick.session.step().value()) {
    take(kick.events.update(kick.session));
    std::set<TouchPair> now;
    for (const Contact& contact : kick.session.world().contacts()) {
      now.insert({TouchKind::kProp, 0, contact.part, 0, contact.prop});
    }
    for (const SelfContact& contact : kick.session.selfContacts()) {
      now.insert({TouchKind::kSelf, 0, contact.first, 0, contact.second});
    }
    for (const TouchPair& pair : now) flickers += before.contains(pair) ? 0 : 1;
    before = now;
  }
  take(kick.events.endAll());
  EXPECT_TRUE(open.empty());
  EXPECT_GT(begins, 5);
  EXPECT_LE(begins, flickers);  // what a user without events would count
  RecordProperty("begins", begins);
  RecordProperty("rawBegins", flickers);
}

TEST(ContactEvents, TheSameSessionHasTheSameEvents) {
  Kick a, b;
  while (a.session.step().value() && b.session.step().value()) {
    const std::span<const ContactEvent> first = a.events.update(a.session);
    const std::span<const ContactEvent> second = b.events.update(b.session);
    ASSERT_EQ(first.size(), second.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
      EXPECT_EQ(first[i].phase, second[i].phase);
      EXPECT_EQ(first[i].touch.pair, second[i].touch.pair);
      EXPECT_EQ(first[i].touch.bone, second[i].touch.bone);
      EXPECT_EQ(first[i].touch.point, second[i].touch.point);
      EXPECT_EQ(first[i].touch.depth, second[i].touch.depth);
      EXPECT_EQ(first[i].touch.strength, second[i].touch.strength);
    }
  }
}

TEST(ContactEvents, UpdatingAllocatesNothing) {
  Session session = swayingHair(inAndOut());
  ContactEvents events(session);
  for (int frame = 0; frame < 4; ++frame) {
    ASSERT_TRUE(session.step().value());
    (void)events.update(session);
  }
  while (session.step().value()) {
    const long before = test::allocationCount();
    (void)events.update(session);
    EXPECT_EQ(test::allocationCount() - before, 0);
  }
}

struct Body {
  Character character = makeMannequin();
  Decomposition parts;
  LiveBody live;

  Body() : parts(cut(character)), live(LiveBody::create(parts, character).value()) {
    const std::vector<Affine3> bindPose(static_cast<std::size_t>(character.skeleton.jointCount()), Affine3::Identity());
    live.update(bindPose);
  }
  static Decomposition cut(const Character& character) {
    DecomposeSettings settings;
    settings.maxParts = 8;
    return decompose(character.mesh, {character.mesh.vertices, static_cast<int>(character.mesh.vertices.size())},
                     settings)
        .value();
  }
  /// Blend weight of a joint at a point.
  [[nodiscard]] double weight(VertexIndex vertex, JointIndex joint) const {
    double sum = 0.0;
    const auto v = static_cast<std::size_t>(vertex);
    for (std::uint32_t i = character.influenceBegin[v]; i < character.influenceBegin[v + 1]; ++i) {
      if (character.influences[i].joint == static_cast<decltype(character.influences[i].joint)>(joint)) {
        sum += character.influences[i].weight;
      }
    }
    return sum;
  }
};

const Body& body() {
  static const Body made;
  return made;
}

TEST(ContactBones, ACornerOfAHullIsMovedByTheJointWithItsLargestWeight) {
  ContactBones bones(body().parts, body().character);
  int corners = 0;
  for (const LivePart& part : body().live.parts()) {
    for (std::size_t i = 0; i < part.shape.vertices.size(); ++i) {
      const VertexIndex point = part.shape.pointOfVertex[i];
      if (point >= body().parts.vertexCount) continue;
      const JointIndex found = bones.at(part, part.worldFromPart * part.shape.vertices[i]);
      double largest = 0.0;
      for (JointIndex j = 0; j < body().character.skeleton.jointCount(); ++j) {
        largest = std::max(largest, body().weight(point, j));
      }
      EXPECT_NEAR(body().weight(point, found), largest, 1e-6) << "vertex " << point;
      ++corners;
    }
  }
  EXPECT_GT(corners, 300);
}

TEST(ContactBones, InsideAFaceTheWeightsOfItsCornersAreBlended) {
  ContactBones bones(body().parts, body().character);
  int blended = 0;
  for (const LivePart& part : body().live.parts()) {
    for (const Triangle& t : part.shape.triangles) {
      const Vec3 shares(0.5, 0.3, 0.2);
      Vec3 position = Vec3::Zero();
      std::vector<double> weights(static_cast<std::size_t>(body().character.skeleton.jointCount()), 0.0);
      bool vertices = true;
      for (int i = 0; i < 3; ++i) {
        const auto corner = static_cast<std::size_t>(t[i]);
        const VertexIndex point = part.shape.pointOfVertex[corner];
        vertices = vertices && point < body().parts.vertexCount;
        position += shares[i] * part.shape.vertices[corner];
        for (std::size_t j = 0; vertices && j < weights.size(); ++j) {
          weights[j] += shares[i] * body().weight(point, static_cast<JointIndex>(j));
        }
      }
      if (!vertices) continue;
      // Slightly outside, like contacts.
      const JointIndex found = bones.at(part, part.worldFromPart * Vec3(1.0001 * position));
      EXPECT_NEAR(weights[found], *std::max_element(weights.begin(), weights.end()), 0.02);
      ++blended;
    }
  }
  EXPECT_GT(blended, 300);
}

TEST(ContactBones, AKickIsTheRightFoots) {
  const Character& character = body().character;
  World world;
  Prop ball;
  ball.shape = PropShape::kSphere;
  ball.halfExtents = Vec3::Constant(0.15);
  ball.mass = 0.3;
  ball.worldFromProp = Eigen::Translation3d(0.0, 1.0, 1.1);
  world.addProp(ball);
  Prop post = ball;
  post.halfExtents = Vec3(0.05, 0.425, 0.05);
  post.shape = PropShape::kCylinder;
  post.mass = 0.0;
  post.worldFromProp = Eigen::Translation3d(0.0, 0.425, 1.1);
  world.addProp(post);
  std::unique_ptr<PoseSource> source =
      makeJointPoseSource(character.skeleton, makeRecordedSource(shippedFrames("punch_and_kick"))).value();
  Session session = Session::create(character, body().parts, std::move(source), std::move(world)).value();
  int contacts = 0;
  while (contacts == 0) {
    const Result<bool> more = session.step();
    ASSERT_TRUE(more.ok() && *more) << "nobody kicked the ball";
    for (const Contact& contact : session.world().contacts()) {
      ASSERT_NE(contact.bone, kNoJoint);
      const std::string& name = character.skeleton.joint(contact.bone).name;
      EXPECT_TRUE(name == "rightFoot" || name == "rightToes" || name == "rightLowerLeg") << name;
      ++contacts;
    }
  }
  EXPECT_TRUE(session.selfContacts().empty()) << "a kick has no self-contacts";
}

TEST(ContactBones, APartWithoutFacesHasNone) {
  ContactBones bones(body().parts, body().character);
  EXPECT_EQ(bones.at(LivePart(), Vec3::Zero()), kNoJoint);
}

}  // namespace
}  // namespace lorica
