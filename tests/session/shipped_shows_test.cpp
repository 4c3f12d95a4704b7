#include "capture/files/joint_csv.h"
#include "session/contact_events.h"
#include "session/scenes/scene_file.h"
#include "session/session.h"
#include "session/treated_source.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/session/small_session.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <ostream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

/// The shipped scenes whose own avatars perform.
namespace lorica {
namespace {

SceneFile shipped(const std::string& name) {
  Result<SceneFile> scene = readScene(test::recordingsFolder() / "scenes" / (name + ".json"));
  EXPECT_TRUE(scene.ok()) << scene.error().message;
  return std::move(scene).value();
}

/// The scene with its avatars, as `lorica play --scene` sets it up, but of eight parts.
Session performance(const SceneFile& scene) {
  Session session(makeWorld(scene).value());
  for (const AvatarSetting& asked : scene.stage) {
    std::unique_ptr<PoseSource> source =
        makeTreatedSource(makeMannequin(), makeRecordedSource(test::shippedFrames(asked.motion, 10'000, asked.start)),
                          {})
            .value();
    SessionAvatar avatar = SessionAvatar::create(makeMannequin(), test::eightParts(), std::move(source)).value();
    avatar.setPlace(Isometry3(Eigen::Translation3d(asked.place)));
    session.addAvatar(std::move(avatar));
  }
  return session;
}

/// Cosine of the angle by which a prop has turned away from upright.
double uprightness(const Session& session, std::size_t prop) {
  return session.world().props()[prop].worldFromProp.linear()(1, 1);
}

TEST(ShippedShows, AFootStartsTheDominoesAndAllFallInOrder) {
  const SceneFile scene = shipped("dominoes");
  Session session = performance(scene);
  std::vector<double> fell(scene.props.size(), 0.0);  // when each was 20 degrees from upright
  while (session.step().value()) {
    for (const Contact& contact : session.world().contacts()) {
      EXPECT_LE(contact.prop, 1) << "only the first is kicked";
      EXPECT_EQ(limbOf(session.character().skeleton, contact.bone), HitLimb::kRightFoot);
    }
    for (std::size_t i = 0; i < fell.size(); ++i) {
      if (fell[i] == 0.0 && uprightness(session, i) < 0.94) fell[i] = session.time();
    }
  }
  ASSERT_GE(fell.size(), 100u);
  for (std::size_t i = 0; i < fell.size(); ++i) {
    EXPECT_LT(uprightness(session, i), 0.5) << "domino " << i << " stands";
    EXPECT_GE(fell[i], i > 0 ? fell[i - 1] : 0.1) << "domino " << i;
  }
  EXPECT_LT(fell.back() - scene.stage[0].start, 10.0) << "within ten seconds of the play";
}

/// The greatest distance of the two ends of a link's joint [m].
double widestGap(const SceneFile& scene, const Session& session) {
  const auto now = [&](int prop, const Vec3& position) -> Vec3 {
    if (prop == kWorldItself) return position;
    const auto p = static_cast<std::size_t>(prop);
    return session.world().props()[p].worldFromProp * (scene.props[p].worldFromProp.inverse() * position);
  };
  double widest = 0.0;
  for (const SceneFile::Link& link : scene.links) {
    widest = std::max(widest, (now(link.a, link.position) - now(link.b, link.position)).norm());
  }
  return widest;
}

TEST(ShippedShows, PlanksOfTheBridgeYieldToTheFeetAndNothingTears) {
  const SceneFile scene = shipped("bridge");
  World world = makeWorld(scene).value();  // where the planks hang without anybody
  for (int i = 0; i < 90; ++i) world.step({}, 1.0 / 30.0);
  Session session = performance(scene);
  std::map<int, double> pressed;  // how far each plank that a foot touched was below where it hangs
  double fastest = 0.0, gap = 0.0;
  while (session.step().value()) {
    for (const Contact& contact : session.world().contacts()) {
      const Prop& prop = session.world().props()[static_cast<std::size_t>(contact.prop)];
      if (prop.shape != PropShape::kBox) continue;
      const HitLimb limb = limbOf(session.character().skeleton, contact.bone);
      EXPECT_TRUE(limb == HitLimb::kLeftFoot || limb == HitLimb::kRightFoot);
      const double depth = world.props()[static_cast<std::size_t>(contact.prop)].worldFromProp.translation().y() -
                           prop.worldFromProp.translation().y();
      pressed[contact.prop] = std::max(pressed[contact.prop], depth);
    }
    for (const Prop& prop : session.world().props()) {
      if (prop.mass > 0.0) fastest = std::max(fastest, prop.velocity.norm());
    }
    gap = std::max(gap, widestGap(scene, session));
  }
  EXPECT_GE(std::count_if(pressed.begin(), pressed.end(), [](const auto& plank) { return plank.second > 0.01; }), 8);
  EXPECT_LT(gap, 0.1);
  EXPECT_LT(widestGap(scene, session), 0.02) << "links may stretch under a foot, but never tear";
  EXPECT_LT(fastest, 5.0);
}

TEST(ShippedShows, HitsOfTargetsAreTheContactsThatEventsTell) {
  const SceneFile scene = shipped("targets");
  ASSERT_EQ(scene.targets.size(), 3u);
  Session session = performance(scene);
  HitCounter counter(scene.targets);
  ContactEvents events(session);
  /// Contacts of a limb with a target: begin and end.
  using Key = std::tuple<std::size_t, HitLimb, int>;  // target, limb, avatar
  std::map<Key, std::vector<std::pair<double, double>>> contacts;
  const auto note = [&](std::span<const ContactEvent> told) {
    for (const ContactEvent& event : told) {
      if (event.phase != ContactPhase::kEnd || event.touch.pair.kind != TouchKind::kProp) continue;
      for (std::size_t target = 0; target < scene.targets.size(); ++target) {
        const std::vector<int>& props = scene.targets[target].props;
        if (std::find(props.begin(), props.end(), event.touch.pair.other) == props.end()) continue;
        const Skeleton& skeleton = session.avatar(event.touch.pair.avatar).character().skeleton;
        contacts[{target, limbOf(skeleton, event.touch.bone), event.touch.pair.avatar}].emplace_back(event.began,
                                                                                                     event.time);
      }
    }
  };
  while (session.step().value()) {
    const std::span<const ContactEvent> told = events.update(session);
    counter.add(told, session);
    note(told);
  }
  for (ContactEvent event : events.endAll()) {
    event.time += 1.0;  // all of these go on
    note(std::span(&event, 1));
  }
  std::vector<HitCounter::Hits> expected(scene.targets.size(), HitCounter::Hits{});
  for (auto& [key, spans] : contacts) {
    std::sort(spans.begin(), spans.end());
    double end = -1.0;
    for (const auto& [began, ended] : spans) {
      if (began >= end) ++expected[std::get<0>(key)][static_cast<std::size_t>(std::get<1>(key))];
      end = std::max(end, ended);
    }
  }
  for (std::size_t target = 0; target < scene.targets.size(); ++target) {
    EXPECT_EQ(counter.hitsOf(target), expected[target]) << scene.targets[target].name;
  }
  const auto hits = [&](std::size_t target, HitLimb limb) {
    return counter.hitsOf(target)[static_cast<std::size_t>(limb)];
  };
  EXPECT_GE(hits(0, HitLimb::kLeftHand) + hits(0, HitLimb::kRightHand), 3) << "fists hit the bag";
  EXPECT_GE(hits(0, HitLimb::kRightFoot), 1) << "a kick hits it";
  EXPECT_GE(hits(1, HitLimb::kRightHand), 3) << "jumping hits the yellow rope";
  EXPECT_GE(hits(2, HitLimb::kLeftHand), 2) << "and the blue one";
}

TEST(HitCounter, AFistOfTwoPartsHitsOnceAndAgainAfterItLeft) {
  const Session session = test::demoSession(
      makeTreatedSource(makeMannequin(), makeRecordedSource(test::shippedFrames("wave", 2)), {}).value());
  const Skeleton& skeleton = session.character().skeleton;
  HitCounter counter({{"ball", {4}}, {"box", {2, 3}}});
  const auto event = [&](ContactPhase phase, PartIndex part, int prop, HumanBone bone) {
    return ContactEvent{phase, {{TouchKind::kProp, 0, part, 0, prop}, skeleton.jointOf(bone)}};
  };
  const auto add = [&](std::vector<ContactEvent> events) { counter.add(events, session); };
  add({event(ContactPhase::kBegin, 1, 2, HumanBone::kLeftHand), event(ContactPhase::kBegin, 2, 3, HumanBone::kLeftHand),
       event(ContactPhase::kBegin, 5, 3, HumanBone::kLeftFoot),
       event(ContactPhase::kBegin, 6, 1, HumanBone::kLeftHand)});
  EXPECT_EQ(counter.hitsOf(1), (HitCounter::Hits{1, 0, 1, 0, 0})) << "hand and foot; prop 1 is no target";
  add({event(ContactPhase::kEnd, 1, 2, HumanBone::kLeftHand)});
  add({event(ContactPhase::kBegin, 1, 2, HumanBone::kLeftHand)});
  EXPECT_EQ(counter.hitsOf(1), (HitCounter::Hits{1, 0, 1, 0, 0})) << "the other part of the fist never left";
  add({event(ContactPhase::kEnd, 1, 2, HumanBone::kLeftHand), event(ContactPhase::kEnd, 2, 3, HumanBone::kLeftHand)});
  add({event(ContactPhase::kBegin, 1, 2, HumanBone::kLeftHand), event(ContactPhase::kBegin, 9, 4, HumanBone::kHead)});
  EXPECT_EQ(counter.hitsOf(1), (HitCounter::Hits{2, 0, 1, 0, 0}));
  EXPECT_EQ(counter.hitsOf(0), (HitCounter::Hits{0, 0, 0, 0, 1}));
}

TEST(HitCounter, FingersAreOfTheHandAndToesOfTheFoot) {
  const auto joint = [](JointIndex parent, std::optional<HumanBone> bone) {
    return Joint{"j" + std::to_string(parent + 1), parent, {}, bone};
  };
  const Skeleton skeleton =
      Skeleton::create({joint(kNoJoint, HumanBone::kHips), joint(0, HumanBone::kRightHand), joint(1, std::nullopt),
                        joint(2, std::nullopt), joint(0, HumanBone::kLeftFoot), joint(4, HumanBone::kLeftToes)})
          .value();
  EXPECT_EQ(limbOf(skeleton, 3), HitLimb::kRightHand);
  EXPECT_EQ(limbOf(skeleton, 5), HitLimb::kLeftFoot);
  EXPECT_EQ(limbOf(skeleton, 0), HitLimb::kRest);
  EXPECT_EQ(limbOf(skeleton, kNoJoint), HitLimb::kRest);
}

/// Expected hash of the first frames of a scene: the same for every build, compiler and number of threads. After an
/// intended change of poses, hulls, physics or the scene, copy the number that the test prints.
struct Known {
  const char* scene;
  std::uint64_t hash;
};
void PrintTo(const Known& known, std::ostream* out) {
  *out << known.scene;
}

class KnownShow : public testing::TestWithParam<Known> {};

TEST_P(KnownShow, ComesOutTheSameOnOneThreadAndTwoAndAsItAlwaysDid) {
  const SceneFile scene = shipped(GetParam().scene);
  for (const std::size_t threads : {std::size_t{1}, std::size_t{2}}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    Session session = performance(scene);
    for (int frame = 0; frame < 75; ++frame) ASSERT_TRUE(session.step().value());
    EXPECT_EQ(session.hash(), GetParam().hash) << threads << " threads: 0x" << std::hex << session.hash();
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, KnownShow,
                         testing::Values(Known{"bridge", 0x68f2f72c9cf0b44bu}, Known{"dominoes", 0x70bb75e533e37ed3u},
                                         Known{"targets", 0x27a29718531130u}),
                         [](const auto& param) { return std::string(param.param.scene); });

}  // namespace
}  // namespace lorica
