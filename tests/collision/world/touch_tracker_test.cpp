#include "collision/world/touch_tracker.h"

#include "tests/support/allocations.h"

#include <gtest/gtest.h>

#include <random>
#include <span>
#include <string>
#include <vector>

namespace lorica {
namespace {

constexpr double kFrame = 1.0 / 30.0;

Touch touchOf(TouchKind kind, int other, double depth = 0.01, double strength = 1.0) {
  Touch touch;
  touch.pair = {kind, 0, 1, 0, other};
  touch.bone = 5;
  touch.depth = depth;
  touch.strength = strength;
  return touch;
}

/// Phases of one contact in frames where it is touched ('x') or not ('.'), as B, S, E; '.' without an event.
std::string phases(const std::string& touched, double depth = 0.01, TouchKind kind = TouchKind::kProp) {
  TouchTracker tracker;
  std::string found;
  const Touch touch = touchOf(kind, 0, depth);
  for (std::size_t frame = 0; frame < touched.size(); ++frame) {
    const auto touches = std::span(&touch, touched[frame] == 'x' ? 1 : 0);
    const std::span<const ContactEvent> events = tracker.update(touches, static_cast<double>(frame) * kFrame);
    EXPECT_LE(events.size(), 1U);
    found += events.empty() ? '.' : "BSE"[static_cast<int>(events[0].phase)];
  }
  return found;
}

TEST(TouchTracker, AContactBeginsStaysAndEnds) {
  EXPECT_EQ(phases(".xx......"), ".BSSSE...");
}

TEST(TouchTracker, AOneFrameTouchBeginsAtOnce) {
  EXPECT_EQ(phases("x.....x"), "BSSE..B");
}

TEST(TouchTracker, ShortGapsDoNotEndAContact) {
  EXPECT_EQ(phases("x.x..x.xx..x...."), "BSSSSSSSSSSSSSE.");
}

TEST(TouchTracker, TwoPartsBeginWhenTheyOverlapByThreeMillimetres) {
  EXPECT_EQ(phases("xxx", 0.0029, TouchKind::kSelf), "...");
  EXPECT_EQ(phases("xxx", 0.0031, TouchKind::kSelf), "BSS");
  EXPECT_EQ(phases("xxx", 0.0031, TouchKind::kAvatars), "BSS");
  EXPECT_EQ(phases("xxx", 0.0, TouchKind::kProp), "BSS");
}

TEST(TouchTracker, NoiseAroundTouchingBeginsNothing) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> depth(-0.0028, 0.0028);
  TouchTracker tracker;
  for (int frame = 0; frame < 300; ++frame) {
    const Touch touch = touchOf(TouchKind::kSelf, 3, depth(random));
    EXPECT_TRUE(tracker.update(std::span(&touch, touch.depth > 0.0 ? 1 : 0), frame * kFrame).empty());
  }
}

TEST(TouchTracker, AHeldContactKeepsItsPlaceWithoutDepthAndStrength) {
  TouchTracker tracker;
  Touch touch = touchOf(TouchKind::kProp, 4);
  touch.point = Vec3(1, 2, 3);
  (void)tracker.update(std::span(&touch, 1), 1.0);
  const std::span<const ContactEvent> held = tracker.update({}, 1.0 + kFrame);
  ASSERT_EQ(held.size(), 1U);
  EXPECT_EQ(held[0].phase, ContactPhase::kStay);
  EXPECT_EQ(held[0].touch.point, Vec3(1, 2, 3));
  EXPECT_EQ(held[0].touch.depth, 0.0);
  EXPECT_EQ(held[0].touch.strength, 0.0);
  EXPECT_EQ(held[0].time, 1.0 + kFrame);
  EXPECT_EQ(held[0].touched, 1.0);
  EXPECT_EQ(held[0].began, 1.0);
}

TEST(TouchTracker, TheBonesAreThoseOfTheBegin) {
  TouchTracker tracker;
  Touch touch = touchOf(TouchKind::kSelf, 4);
  (void)tracker.update(std::span(&touch, 1), 0.0);
  touch.bone = 6;
  touch.otherBone = 7;
  const std::span<const ContactEvent> events = tracker.update(std::span(&touch, 1), kFrame);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].touch.bone, 5);
  EXPECT_EQ(events[0].touch.otherBone, kNoJoint);
}

TEST(TouchTracker, AllContactsEndWhenTimeGoesBackOrTheStreamEnds) {
  TouchTracker tracker;
  const Touch touches[] = {touchOf(TouchKind::kProp, 0), touchOf(TouchKind::kSelf, 2)};
  (void)tracker.update(touches, 5.0);
  const std::span<const ContactEvent> back = tracker.update(std::span(touches).first(1), 1.0);
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(back[0].phase, ContactPhase::kStay);
  EXPECT_EQ(back[1].phase, ContactPhase::kEnd);
  const std::span<const ContactEvent> last = tracker.endAll();
  ASSERT_EQ(last.size(), 1U);
  EXPECT_EQ(last[0].phase, ContactPhase::kEnd);
  EXPECT_EQ(last[0].touch.pair, touches[0].pair);
  EXPECT_EQ(last[0].time, 1.0);
  EXPECT_TRUE(tracker.endAll().empty());
}

/// Random touches of 40 pairs, against a slow count of each pair on its own.
TEST(TouchTracker, ManyContactsAreTrackedAsEachAlone) {
  std::mt19937 random(3);
  constexpr int kPairs = 40, kFrames = 400;
  std::vector<std::string> touched(kPairs);
  for (std::string& frames : touched) {
    bool on = false;
    for (int frame = 0; frame < kFrames; ++frame) {
      if (random() % 5 == 0) on = !on;
      frames += on ? 'x' : '.';
    }
  }
  TouchTracker tracker;
  std::vector<std::string> found(kPairs, std::string(kFrames, '.'));
  std::vector<Touch> touches;
  for (int frame = 0; frame < kFrames; ++frame) {
    touches.clear();
    for (int pair = 0; pair < kPairs; ++pair) {
      if (touched[pair][frame] == 'x') touches.push_back(touchOf(TouchKind::kProp, pair));
    }
    for (const ContactEvent& event : tracker.update(touches, frame * kFrame)) {
      found[event.touch.pair.other][frame] = "BSE"[static_cast<int>(event.phase)];
    }
  }
  for (int pair = 0; pair < kPairs; ++pair) EXPECT_EQ(found[pair], phases(touched[pair]));
}

TEST(TouchTracker, NothingIsAllocatedOnceTheMostTouchesWereSeen) {
  TouchTracker tracker;
  std::vector<Touch> touches;
  for (int prop = 0; prop < 100; ++prop) touches.push_back(touchOf(TouchKind::kProp, prop));
  for (int frame = 0; frame < 3; ++frame) (void)tracker.update(touches, frame * kFrame);
  const long before = test::allocationCount();
  for (int frame = 3; frame < 50; ++frame) {
    (void)tracker.update(std::span(touches).first(frame % 7 == 0 ? 0 : 100), frame * kFrame);
  }
  EXPECT_EQ(test::allocationCount() - before, 0);
}

}  // namespace
}  // namespace lorica
