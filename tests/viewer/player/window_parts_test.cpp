#include "acd/decompose.h"
#include "capture/files/joint_csv.h"
#include "collision/live/live_body.h"
#include "session/prepare/detail_levels.h"
#include "session/scenes/demo_scene.h"
#include "session/treated_source.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/session/small_session.h"
#include "tests/support/meshes.h"
#include "viewer/player/follow_camera.h"
#include "viewer/player/hands.h"
#include "viewer/player/parts_picture.h"
#include "viewer/player/window_opener.h"
#include "viewer/player/window_texts.h"

#include <gtest/gtest.h>

#include <chrono>
#include <set>
#include <thread>

namespace lorica {
namespace {

const Character& mannequin() {
  static const Character character = makeMannequin();
  return character;
}

const Decomposition& sixParts() {
  static const Decomposition result = [] {
    DecomposeSettings settings;
    settings.maxParts = 6;
    const PoseView bindPose{mannequin().mesh.vertices, static_cast<int>(mannequin().mesh.vertices.size())};
    Result<Decomposition> made = decompose(mannequin().mesh, bindPose, settings);
    EXPECT_TRUE(made.ok()) << made.error().message;
    return std::move(made).value();
  }();
  return result;
}

/// A pose with every joint rotated slightly from the bind pose.
std::vector<Affine3> bentBones() {
  Pose pose = restPose(mannequin().skeleton);
  for (std::size_t j = 0; j < pose.size(); ++j) {
    pose[j].rotation = pose[j].rotation * Quat(Eigen::AngleAxisd(j % 2 == 0 ? 0.3 : -0.25, Vec3(1, 2, 3).normalized()));
  }
  std::vector<Affine3> worldFromJoint(pose.size()), worldFromModel(pose.size());
  computeWorldFromJoint(mannequin().skeleton, pose, worldFromJoint);
  computeWorldFromModel(mannequin(), worldFromJoint, worldFromModel);
  return worldFromModel;
}

/// Largest distance of a vertex of the posed mesh outside all hulls [m].
double farthestOutside(const LiveBody& body, std::span<const Affine3> bones) {
  std::vector<Vec3> posed(mannequin().mesh.vertices.size());
  skinLinearBlend(mannequin(), bones, posed);
  double farthest = 0.0;
  for (std::size_t v = 0; v < posed.size(); v += 7) {
    double nearest = 1e9;
    for (const LivePart& part : body.parts()) {
      const ConvexHull hull = worldHull(part);
      double outside = -1e9;
      for (const Triangle& t : hull.triangles) {
        const Vec3& a = hull.vertices[t[0]];
        const Vec3& b = hull.vertices[t[1]];
        const Vec3& c = hull.vertices[t[2]];
        const Vec3 normal = (b - a).cross(c - a);
        if (normal.norm() < 1e-12) continue;
        outside = std::max(outside, normal.normalized().dot(posed[v] - a));
      }
      nearest = std::min(nearest, outside);
    }
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

TEST(DetailLevels, EveryLevelHasItsPartsAndHoldsTheBody) {
  const auto finest = BodyPlan::create(sixParts(), mannequin()).value();
  const std::vector<Affine3> bones = bentBones();
  double before = 1e9;
  for (int parts = 1; parts <= 6; ++parts) {
    const std::shared_ptr<const BodyPlan> plan = planOfLevel(finest, mannequin(), parts);
    ASSERT_EQ(plan->decomposition().parts.size(), static_cast<std::size_t>(parts));
    LiveBody body(plan);
    body.update(bones);
    EXPECT_LT(farthestOutside(body, bones), 1e-6) << parts << " parts";
    double volume = 0.0;
    for (const LivePart& part : body.parts()) volume += part.shape.volume;
    EXPECT_LT(volume, before) << parts << " parts fit more closely than one fewer";
    before = volume;
  }
  EXPECT_EQ(planOfLevel(finest, mannequin(), 6), finest);
}

TEST(DetailLevels, ChosenPointsStayChosenWherePartsAreJoined) {
  // An arbitrary cover of at most four points per part, pushed outward.
  const auto all = BodyPlan::create(sixParts(), mannequin()).value();
  HullCover cover = all->coverage();
  cover.tolerance = 0.01;
  cover.maxHullVertices = 4;
  std::size_t count = 0;
  for (std::vector<CoverPoint>& points : cover.points) {
    points.resize(std::min<std::size_t>(points.size(), 4));
    for (CoverPoint& p : points) p.outward = Vec3(0.0, 0.001, 0.0);
    count += points.size();
  }
  const auto finest = BodyPlan::create(sixParts(), mannequin(), cover).value();
  const std::shared_ptr<const BodyPlan> one = planOfLevel(finest, mannequin(), 1);
  ASSERT_EQ(one->coverage().points.size(), 1u);
  EXPECT_EQ(one->coverage().points[0].size(), count);
  EXPECT_EQ(one->coverage().tolerance, 0.01);
  EXPECT_EQ(one->coverage().maxHullVertices, 0) << "the limit no longer holds";
  LiveBody body(one);
  body.update(bentBones());
  EXPECT_FALSE(body.parts()[0].shape.degenerate());
}

TEST(DetailLevels, AreMadeInAnotherThreadAndTheLastRequestCounts) {
  const auto finest = BodyPlan::create(sixParts(), mannequin()).value();
  DetailLevels levels(finest, mannequin());
  EXPECT_EQ(levels.maxParts(), 6);
  EXPECT_EQ(levels.take(), nullptr) << "nothing was requested";
  const auto wait = [&levels] {
    std::shared_ptr<const BodyPlan> plan;
    while ((plan = levels.take()) == nullptr) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return plan;
  };
  levels.ask(2);
  (void)levels.take();
  levels.ask(4);
  EXPECT_EQ(levels.asked(), 4);
  const std::shared_ptr<const BodyPlan> four = wait();
  EXPECT_EQ(four->decomposition().parts.size(), 4u);
  EXPECT_FALSE(levels.asked().has_value());
  EXPECT_EQ(levels.take(), nullptr) << "once";
  levels.ask(6);
  EXPECT_EQ(levels.take(), finest) << "is available immediately";
  levels.ask(4);
  EXPECT_EQ(levels.take(), four) << "is kept";
}

/// A session that can restart, and the user's actions in it.
struct TapedSession {
  std::vector<SkeletonFrame> frames = test::shippedFrames("walk", 40);
  Session session = test::demoSession(source());
  ActionTape tape;

  [[nodiscard]] std::unique_ptr<PoseSource> source() const {
    return makeTreatedSource(mannequin(), makeRecordedSource(frames), {}).value();
  }
  /// Restarts from the first frame. @return the hashes after each frame
  std::vector<SessionHashes> runAgain(int count) {
    tape.rewind();
    session.restart(source(), makeDemoWorld(kDemoSeed));
    return run(count);
  }
  std::vector<SessionHashes> run(int count) {
    std::vector<SessionHashes> hashes;
    for (int i = 0; i < count; ++i) {
      tape.redo(session);
      EXPECT_TRUE(session.step().value());
      hashes.push_back(session.hashes());
    }
    return hashes;
  }
};

const WorldAction& aBall() {
  static const WorldAction ball = WorldAction::throwBall({0.0, 1.2, 1.5}, {0.0, 1.0, -6.0}, 0.1);
  return ball;
}

TEST(ActionTape, ARunFromTheStartDoesTheSameAgain) {
  TapedSession s;
  const std::vector<SessionHashes> untouched = s.runAgain(30);
  s.runAgain(5);
  std::vector<SessionHashes> first = {s.session.hashes()};
  const auto act = [&s](const WorldAction& action) { s.tape.act(s.session, action); };
  const auto runOn = [&](int count) {
    for (const SessionHashes& h : s.run(count)) first.push_back(h);
  };
  act(aBall());
  runOn(3);
  act(WorldAction::grab(0, s.session.world().props()[0].worldFromProp.translation()));
  for (int i = 0; i < 8; ++i) {
    act(WorldAction::moveGrab(Vec3(0.3, 0.5 + 0.05 * i, 0.8)));
    runOn(1);
  }
  act(WorldAction::release());
  runOn(14);
  const std::vector<SessionHashes> again = s.runAgain(30);
  for (std::size_t f = 0; f < first.size(); ++f) EXPECT_EQ(first[f], again[f + 4]) << f + 4;
  EXPECT_NE(again.back().props, untouched.back().props);
  EXPECT_EQ(s.runAgain(30).back(), again.back()) << "and a third time";
}

TEST(ActionTape, TheLastBallOrDragIsUndone) {
  TapedSession s;
  const std::vector<SessionHashes> untouched = s.runAgain(20);
  s.runAgain(3);
  EXPECT_FALSE(s.tape.hasLast());
  s.tape.act(s.session, WorldAction::grab(0, s.session.world().props()[0].worldFromProp.translation()));
  for (int i = 0; i < 4; ++i) {
    s.tape.act(s.session, WorldAction::moveGrab(Vec3(0.3, 0.5, 0.8)));
    s.run(1);
  }
  s.tape.act(s.session, WorldAction::release());
  s.run(13);
  const SessionHashes dragged = s.session.hashes();
  s.runAgain(7);
  s.tape.act(s.session, aBall());
  s.run(13);
  EXPECT_NE(s.session.hashes(), dragged);
  s.tape.forgetLast();
  EXPECT_EQ(s.runAgain(20).back(), dragged) << "without the ball";
  s.tape.forgetLast();
  EXPECT_FALSE(s.tape.hasLast());
  EXPECT_EQ(s.runAgain(20).back(), untouched.back()) << "without the drag";
  s.tape.forgetLast();  // nothing is left
}

TEST(ActionTape, TheDragOfOneHandIsUndoneAndTheOthersStays) {
  TapedSession s;
  s.runAgain(3);
  const auto act = [&s](const WorldAction& action) { s.tape.act(s.session, action); };
  const auto drags = [&](bool both) {
    s.tape.clear();
    s.runAgain(3);
    for (int hand = 0; hand < (both ? 2 : 1); ++hand) {
      act(WorldAction::grab(hand, s.session.world().props()[hand].worldFromProp.translation(), hand));
    }
    for (int i = 0; i < 4; ++i) {
      for (int hand = 0; hand < (both ? 2 : 1); ++hand) act(WorldAction::moveGrab(Vec3(0.3, 0.5 + hand, 0.8), hand));
      if (both && i == 2) act(aBall());
      s.run(1);
    }
    for (int hand = 0; hand < (both ? 2 : 1); ++hand) act(WorldAction::release(Vec3::Zero(), hand));
    s.run(10);
    return s.session.hashes();
  };
  const SessionHashes one = drags(false);
  EXPECT_NE(drags(true), one);
  s.tape.forgetLast();  // the second hand's drag
  const SessionHashes withBall = s.runAgain(17).back();
  EXPECT_NE(withBall, one);
  s.tape.forgetLast();  // the first hand's: its release came last
  EXPECT_NE(s.runAgain(17).back(), withBall);
  s.tape.forgetLast();  // the ball
  EXPECT_FALSE(s.tape.hasLast());
}

TEST(ActionTape, ANewActionReplacesTheRecordedOnesThatFollow) {
  TapedSession s;
  s.runAgain(3);
  s.tape.act(s.session, WorldAction::grab(0, s.session.world().props()[0].worldFromProp.translation()));
  for (int i = 0; i < 10; ++i) {
    s.tape.act(s.session, WorldAction::moveGrab(Vec3(0.3, 0.5, 0.8)));
    s.run(1);
  }
  s.tape.act(s.session, WorldAction::release());
  s.run(5);
  s.runAgain(8);  // the prop is held now
  ASSERT_TRUE(s.session.world().held().has_value());
  EXPECT_TRUE(s.tape.goesOn());
  s.tape.act(s.session, aBall());
  EXPECT_FALSE(s.tape.goesOn());
  s.run(2);
  EXPECT_FALSE(s.session.world().held().has_value()) << "the later release is dropped, too";
  const SessionHashes second = s.session.hashes();
  EXPECT_EQ(s.runAgain(10).back(), second);
  s.tape.clear();
  EXPECT_NE(s.runAgain(10).back(), second);
}

TEST(AvatarFocus, FollowsOneAvatarOrAllWithoutTheirQuickMovements) {
  const std::vector<SkeletonFrame> frames = test::shippedFrames("walk", 40);
  const auto source = [&] { return makeTreatedSource(mannequin(), makeRecordedSource(frames), {}).value(); };
  Session session = test::demoSession(source());
  SessionAvatar second = session.avatar().another(source());
  second.setPlace(Isometry3(Eigen::Translation3d(2.0, 0.0, 0.0)));
  session.addAvatar(std::move(second));
  AvatarFocus all, one;
  one.choose(1);
  EXPECT_FALSE(all.position().has_value()) << "before the first frame";
  ASSERT_TRUE(session.step().value());
  all.update(session);
  one.update(session);
  ASSERT_TRUE(all.position() && one.position());
  EXPECT_NEAR(one.position()->x() - all.position()->x(), 1.0, 1e-9) << "half way between them";
  const Vec3 first = *one.position();
  Vec3 last = first;
  for (int frame = 1; frame < 40; ++frame) {
    ASSERT_TRUE(session.step().value());
    one.update(session);
    EXPECT_LT((*one.position() - last).norm(), 0.06) << "smoothly";
    last = *one.position();
  }
  EXPECT_GT((last - first).norm(), 0.05) << "it walks";

  const Ray fromTheFront{Vec3(last.x(), last.y(), 8.0), -Vec3::UnitZ()};
  EXPECT_EQ(avatarAt(session, fromTheFront), 1);
  EXPECT_EQ(avatarAt(session, {fromTheFront.origin - Vec3(2.0, 0.0, 0.0), -Vec3::UnitZ()}), 0);
  EXPECT_EQ(avatarAt(session, {fromTheFront.origin, Vec3::UnitZ()}), -1) << "behind the eye";
  EXPECT_EQ(avatarAt(session, {Vec3(8.0, last.y(), last.z()), -Vec3::UnitX()}), 1) << "the nearer one";
  EXPECT_EQ(avatarNames(session)[1], "2 " + mannequin().name);
}

TEST(WindowOpener, ListsTheAvatarsThatCanBeOpened) {
  Host host;
  CastRequest present;
  present.character = "/here/robot.vrm";
  WindowOpener opener(present, host);
  opener.list({"/here/hero.glb", "/here/walk.bvh", "/there/Mage.fbx"});
  Controls controls;
  opener.listControls(controls);
  const auto choicesOf = [&](ControlId id) {
    return std::vector(controls[id].choices.begin(), controls[id].choices.end());
  };
  EXPECT_EQ(choicesOf(ControlId::kCharacter),
            (std::vector<std::string>{"/here/hero.glb", "/there/Mage.fbx", "/here/robot.vrm", "mannequin"}));
  EXPECT_EQ(controls[ControlId::kCharacter].value, 2) << "the present one";
  EXPECT_EQ(choicesOf(ControlId::kRecent), std::vector<std::string>{"/here/walk.bvh"});
  EXPECT_TRUE(choicesOf(ControlId::kSent).empty()) << "it is nobody else's business";
}

TEST(PictureOptions, AreSizesAndBackgrounds) {
  EXPECT_EQ(pictureSizeOf("640x360")->width, 640);
  EXPECT_EQ(pictureSizeOf("portrait")->height, 1920);
  EXPECT_EQ(pictureSizeOf("square")->width, pictureSizeOf("square")->height);
  for (const char* wrong : {"", "640", "640x", "640x360x", "8x8", "9999x10", "x", "wide"}) {
    EXPECT_FALSE(pictureSizeOf(wrong)) << wrong;
  }
  SceneOptions show;
  setBackground(std::nullopt, show);
  EXPECT_TRUE(show.ground && !show.background && !show.transparent);
  setBackground(backgroundNamed("#00ff80"), show);
  EXPECT_LT((*show.background - Vec3f(0.0f, 1.0f, 128 / 255.0f)).norm(), 1e-6f);
  EXPECT_FALSE(show.ground) << "it would not be keyed out";
  setBackground(backgroundNamed("green"), show);
  EXPECT_EQ(*show.background, Vec3f(0.0F, 1.0F, 0.0F));
  setBackground(backgroundNamed("transparent"), show);
  EXPECT_TRUE(show.transparent);
  for (const char* wrong : {"", "greenish", "#00ff0", "#00ff000", "#00fg00", "00ff00"}) {
    EXPECT_FALSE(backgroundNamed(wrong)) << wrong;
  }
}

/// Slabs and legs of a table, as a modeller with Y up writes them, and one with Z up.
TEST(PartsPicture, WhatStandsBroaderIsUp) {
  std::vector<NamedMesh> table = {{"top", test::makeBox({-0.8, 0.7, -0.4}, {0.8, 0.75, 0.4})}};
  for (const double x : {-0.75, 0.7}) {
    for (const double z : {-0.38, 0.33}) table.push_back({"leg", test::makeBox({x, 0, z}, {x + 0.05, 0.7, z + 0.05})});
  }
  EXPECT_EQ(likelyUp(table), UpAxis::kY);
  for (NamedMesh& part : table) {
    for (Vec3& p : part.mesh.vertices) p = Vec3(p.x(), -p.z(), p.y());
  }
  EXPECT_EQ(likelyUp(table), UpAxis::kZ);
  const std::vector<NamedMesh> cube = {{"cube", test::makeBox({0, 0, 0}, {1, 1, 1})}};
  EXPECT_EQ(likelyUp(cube), UpAxis::kY) << "in doubt";
}

TEST(PartColors, AreThoseOfTheBones) {
  const std::vector<PartIndex> six = colorsOfParts(sixParts(), mannequin());
  const std::vector<PartIndex> eight = colorsOfParts(test::eightParts(), mannequin());
  for (const std::vector<PartIndex>& colors : {six, eight}) {
    EXPECT_EQ(std::set<PartIndex>(colors.begin(), colors.end()).size(), colors.size()) << "each has its own";
  }
  const auto colorAt = [](const Decomposition& decomposition, const std::vector<PartIndex>& colors, const Vec3& at) {
    double nearest = 1e9;
    PartIndex color = -1;
    for (std::size_t p = 0; p < decomposition.parts.size(); ++p) {
      for (const Triangle& t : decomposition.parts[p].triangles) {
        const std::size_t v = t[0];
        if (v >= mannequin().mesh.vertices.size()) continue;
        const double distance = (mannequin().mesh.vertices[v] - at).norm();
        if (distance < nearest) nearest = distance, color = colors[p];
      }
    }
    return color;
  };
  const Vec3 left = boundsOf(mannequin().mesh.vertices).max.cwiseProduct(Vec3(0.8, 0.8, 0.0)),
             right(-left.x(), left.y(), 0.0);
  EXPECT_NE(colorAt(test::eightParts(), eight, left), colorAt(test::eightParts(), eight, right));
  const Vec3 head(0.0, mannequin().height, 0.0);
  EXPECT_EQ(colorAt(sixParts(), six, head), colorAt(test::eightParts(), eight, head)) << "however it is decomposed";
}

TEST(WindowWarnings, NameWhatIsLost) {
  const Skeleton& skeleton = mannequin().skeleton;
  std::vector<double> trust(static_cast<std::size_t>(skeleton.jointCount()), 1.0);
  const auto lose = [&](HumanBone bone) { trust[skeleton.jointOf(bone)] = 0.0; };
  std::vector<bool> known;
  EXPECT_EQ(lostLimbs(skeleton, {}, known), "");
  EXPECT_EQ(lostLimbs(skeleton, trust, known), "");
  lose(HumanBone::kLeftHand);
  EXPECT_EQ(lostLimbs(skeleton, trust, known), "left hand lost");
  lose(HumanBone::kLeftLowerArm);
  lose(HumanBone::kRightUpperLeg);
  lose(HumanBone::kHead);
  const std::string four = lostLimbs(skeleton, trust, known);
  EXPECT_NE(four.find("and 1 more lost"), std::string::npos) << four;
  std::fill(trust.begin(), trust.end(), 0.2);
  EXPECT_EQ(lostLimbs(skeleton, trust, known), "the whole body is lost");
}

/// Such as the legs of somebody before a webcam. What comes once is lost when it stops.
TEST(WindowWarnings, WhatNeverCameIsNotLost) {
  const Skeleton& skeleton = mannequin().skeleton;
  std::vector<double> trust(static_cast<std::size_t>(skeleton.jointCount()), 0.0);
  std::vector<bool> known;
  EXPECT_EQ(lostLimbs(skeleton, trust, known), "") << "nothing came yet";
  for (const HumanBone bone : {HumanBone::kHead, HumanBone::kLeftLowerArm}) trust[skeleton.jointOf(bone)] = 1.0;
  EXPECT_EQ(lostLimbs(skeleton, trust, known), "");
  trust[skeleton.jointOf(HumanBone::kHead)] = 0.0;
  EXPECT_EQ(lostLimbs(skeleton, trust, known), "head lost");
  trust[skeleton.jointOf(HumanBone::kLeftLowerArm)] = 0.3;
  EXPECT_EQ(lostLimbs(skeleton, trust, known), "the whole body is lost") << "all that came";
  trust[skeleton.jointOf(HumanBone::kRightFoot)] = 1.0;
  EXPECT_EQ(lostLimbs(skeleton, trust, known), "head, left lower arm lost");
  trust[skeleton.jointOf(HumanBone::kRightFoot)] = 0.0;
  EXPECT_EQ(lostLimbs(skeleton, trust, known), "the whole body is lost");
}

}  // namespace
}  // namespace lorica
