#include "viewer/renderer/controls.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

namespace lorica {
namespace {

using Id = ControlId;

Controls listed(const Choices& choices = {}) {
  Controls controls;
  listChoices(choices, controls);
  return controls;
}

TEST(Controls, HaveNamesAndKeysOfTheirOwn) {
  std::set<std::string> names;
  std::set<std::string_view> keys;
  for (const Control& control : control_rows::kRows) {
    EXPECT_TRUE(names.insert(control.name).second) << control.name;
    EXPECT_EQ(controlNamed(control.name), &control);
    if (control.kind == ControlKind::kOther) continue;
    for (const std::string_view key : {control.key(), control.back()}) {
      EXPECT_TRUE(key.empty() || keys.insert(key).second) << control.name << ": " << key;
    }
    const bool drawn = control.group == ControlGroup::kThings || control.group == ControlGroup::kLook;
    EXPECT_TRUE(!drawn || *control.label != '\0') << control.name;
  }
  EXPECT_EQ(controlNamed("shutdown"), nullptr);
}

TEST(Controls, TwoKeysAreTheOneBeforeAndTheNext) {
  const Controls controls = listed();
  EXPECT_EQ(controls[Id::kParts].back(), "[");
  EXPECT_EQ(controls[Id::kParts].key(), "]");
  EXPECT_EQ(controls[Id::kLoop].back(), "");
  EXPECT_EQ(controls[Id::kLoop].key(), "L");
  EXPECT_EQ(controls[Id::kMirror].key(), "");
}

TEST(Controls, AreAsTheChoicesAre) {
  Choices choices;
  choices.paused = true;
  choices.treatment.gravity = 1;
  choices.show.bones = true;
  choices.show.transparent = true;
  const Controls controls = listed(choices);
  EXPECT_EQ(controls[Id::kPause].value, 1.0);
  EXPECT_EQ(controls[Id::kGravity].value, 1.0);
  EXPECT_EQ(controls[Id::kGravity].choices[1], "moon");
  EXPECT_EQ(controls[Id::kBones].value, 1.0);
  EXPECT_EQ(controls[Id::kBackground].choices[static_cast<std::size_t>(controls[Id::kBackground].value)],
            "transparent");
  EXPECT_FALSE(controls[Id::kPause].absent);
  EXPECT_TRUE(controls[Id::kUndo].absent) << "until a run has it";
}

TEST(Controls, ValuesStayInTheirRange) {
  Control number = listed()[Id::kParts];
  number.least = 1.0;
  number.most = 5.0;
  number.value = 4.0;
  EXPECT_EQ(valueAfter(number, {.id = Id::kParts, .by = 3.0}), 5.0);
  EXPECT_EQ(valueAfter(number, {.id = Id::kParts, .by = -9.0}), 1.0);
  EXPECT_EQ(valueAfter(number, {.id = Id::kParts, .to = 2.0}), 2.0);
  EXPECT_FALSE(valueAfter(number, {.id = Id::kParts, .to = 6.0}));
  EXPECT_FALSE(valueAfter(number, {.id = Id::kParts, .to = 0.0}));
  Control toggle = listed()[Id::kLoop];
  EXPECT_EQ(valueAfter(toggle, {.id = Id::kLoop}), 0.0);
  EXPECT_EQ(valueAfter(toggle, {.id = Id::kLoop, .by = 2.0}), 1.0) << "twice";
  EXPECT_EQ(valueAfter(toggle, {.id = Id::kLoop, .to = 1.0}), 1.0);
}

TEST(Controls, ListsBeginAgainUnlessTheyHaveTwoKeys) {
  const std::vector<std::string> names = {"a", "b", "c"};
  Control list = listed()[Id::kExpression];
  EXPECT_FALSE(valueAfter(list, {.id = Id::kExpression})) << "it is empty";
  list.choices = names;
  list.value = 2.0;
  EXPECT_EQ(valueAfter(list, {.id = Id::kExpression}), 0.0);
  list.least = -1.0;
  EXPECT_EQ(valueAfter(list, {.id = Id::kExpression}), -1.0) << "none can be chosen";
  EXPECT_EQ(valueAfter(list, {.id = Id::kExpression, .by = 2.0}), 0.0);
  list.value = -2.0;  // another one, which is not in the list
  EXPECT_EQ(valueAfter(list, {.id = Id::kExpression}), 0.0);
  for (const double wrong : {-2.0, 3.0, 0.5}) {
    EXPECT_FALSE(valueAfter(list, {.id = Id::kExpression, .to = wrong})) << wrong;
  }
  const Control speed = listed()[Id::kSpeed];
  EXPECT_EQ(valueAfter(speed, {.id = Id::kSpeed, .by = 9.0}), 3.0);
  EXPECT_EQ(valueAfter(speed, {.id = Id::kSpeed, .by = -9.0}), 0.0);
}

TEST(Controls, WhatAScreenKeepsIsDoneAtOnceAndTheRestIsAskedFor) {
  Asked asked;
  asked.ask({.id = Id::kPause});
  asked.ask({.id = Id::kGravity, .to = 9.0});
  asked.ask({.id = Id::kBackground, .to = 4.0});
  EXPECT_TRUE(asked.choices.paused);
  EXPECT_EQ(asked.choices.treatment.gravity, Treatment().gravity);
  EXPECT_EQ(*asked.choices.show.background, Vec3f(0.0f, 1.0f, 0.0f));
  EXPECT_FALSE(asked.choices.show.ground) << "it would not be keyed out";
  asked.ask({.id = Id::kBackground, .to = 1.0});
  EXPECT_TRUE(asked.choices.show.dark && asked.choices.show.ground && !asked.choices.show.background);
  for (int i = 0; i < 3; ++i) asked.ask({.id = Id::kStep});
  EXPECT_EQ(asked.choices.steps, 3);
  EXPECT_TRUE(asked.changes.empty());
  asked.ask({.id = Id::kUndo});
  EXPECT_EQ(asked.changes.size(), 1u);
}

TEST(Controls, OfAControlTheLastValueCountsAndHandsStayInOrder) {
  std::vector<Change> changes;
  addTo(changes, {.id = Id::kSeek, .to = 1.0});
  addTo(changes, {.id = Id::kRelease});
  addTo(changes, {.id = Id::kSeek, .to = 2.0});
  addTo(changes, {.id = Id::kPress});
  addTo(changes, {.id = Id::kRelease});
  addTo(changes, {.id = Id::kSeek, .by = 1.0});
  addTo(changes, {.id = Id::kOpen, .files = {"a"}});
  addTo(changes, {.id = Id::kOpen, .files = {"b"}});
  addTo(changes, {.id = Id::kOpen, .client = -1, .files = {"c"}});
  ASSERT_EQ(changes.size(), 6u);
  EXPECT_EQ(changes[0].to, 3.0);
  EXPECT_EQ(changes[1].id, Id::kRelease);
  EXPECT_EQ(changes[2].id, Id::kPress);
  EXPECT_EQ(changes[3].id, Id::kRelease);
  EXPECT_EQ(changes[4].files, (std::vector<std::string>{"a", "b"}));
  EXPECT_FALSE(takeCancelFrom(changes));
  EXPECT_EQ(changes.size(), 4u) << "files and what was let go outlast what loads";
  addTo(changes, {.id = Id::kCancel});
  EXPECT_TRUE(takeCancelFrom(changes));
}

}  // namespace
}  // namespace lorica
