#include "serve/wish.h"

#include "serve/wire.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace lorica {
namespace {

using test::valueOf;
using Kind = Wish::Kind;

TEST(Wish, MessagesAreRead) {
  EXPECT_EQ(valueOf(readWish(R"({"type":"ack","frame":12345678901234})")).frame, 12345678901234u);
  EXPECT_EQ(valueOf(readWish(R"({"type":"show","layers":["hulls","depth"]})")).layers, served::kHulls | served::kDepth);
  EXPECT_EQ(valueOf(readWish(R"({"type":"show","layers":[]})")).layers, 0u);
  EXPECT_TRUE(valueOf(readWish(R"({"type":"pause","on":true})")).on);
  EXPECT_EQ(valueOf(readWish(R"({"type":"seek","to":1.5})")).to, 1.5);
  EXPECT_EQ(valueOf(readWish(R"({"type":"expression","index":-1})")).index, -1);
  EXPECT_EQ(valueOf(readWish(R"({"type":"parts","count":24})")).index, 24);
  EXPECT_EQ(valueOf(readWish(R"({"type":"undo","more":"is ignored"})")).kind, Kind::kUndo);
  const Wish thrown = valueOf(readWish(R"({"type":"throw","origin":[1,2,3],"target":[-4,5.5,6]})"));
  EXPECT_EQ(thrown.origin, Vec3(1, 2, 3));
  EXPECT_EQ(thrown.target, Vec3(-4, 5.5, 6));
  const Wish press = valueOf(readWish(R"({"type":"press","origin":[0,1,0],"direction":[0,0,2],"forward":[3,0,4]})"));
  EXPECT_EQ(press.direction, Vec3::UnitZ());
  EXPECT_TRUE(press.forward.isApprox(Vec3(0.6, 0.0, 0.8)));
  EXPECT_EQ(press.hand, 0) << "without a number it is the first";
  EXPECT_EQ(
      valueOf(readWish(R"({"type":"drag","hand":1,"origin":[0,1,0],"direction":[0,0,2],"forward":[3,0,4]})")).hand, 1);
  const Wish release = valueOf(readWish(R"({"type":"release","hand":1,"velocity":[3,0,-4]})"));
  EXPECT_EQ(release.hand, 1);
  EXPECT_EQ(release.velocity, Vec3(3, 0, -4));
  EXPECT_EQ(valueOf(readWish(R"({"type":"release"})")).velocity, Vec3::Zero());
  const Wish head =
      valueOf(readWish(R"({"type":"head","time":12.5,"position":[0,1.6,0],"orientation":[0,0.6,0,0.8]})"));
  EXPECT_EQ(head.pose.time, 12.5);
  EXPECT_EQ(head.pose.head.translation(), Vec3(0.0, 1.6, 0.0));
  EXPECT_TRUE(head.pose.head.linear().isApprox(Quat(0.8, 0.0, 0.6, 0.0).toRotationMatrix()));
  EXPECT_FALSE(head.pose.hands[0] || head.pose.hands[1]);
  const Wish hands = valueOf(readWish(R"({"type":"head","time":1,"position":[0,1,0],"orientation":[0,0,0,1],
      "hands":[null,{"position":[0.3,1,-0.2],"orientation":[0,0,1,0]}]})"));
  EXPECT_FALSE(hands.pose.hands[0]);
  ASSERT_TRUE(hands.pose.hands[1]);
  EXPECT_EQ(hands.pose.hands[1]->translation(), Vec3(0.3, 1.0, -0.2));
}

TEST(Wish, WhatIsNoMessageIsRefusedWithASentence) {
  const std::vector<std::pair<std::string, std::string>> rows = {
      {"", "broken"},
      {"[]", "no object with a type"},
      {"{}", "no object with a type"},
      {R"({"type":7})", "no object with a type"},
      {R"({"type":"shutdown"})", "no type that Lorica knows"},
      {R"({"type":"ack"})", "its frame is not"},
      {R"({"type":"ack","frame":-1})", "its frame is not"},
      {R"({"type":"ack","frame":"1"})", "its frame is not"},
      {R"({"type":"show","layers":"hulls"})", "its layers is not a list"},
      {R"({"type":"show","layers":["hulls",3]})", "its layers is not one of"},
      {R"({"type":"show","layers":["everything"]})", "its layers is not one of"},
      {R"({"type":"pause","on":1})", "its on is not true or false"},
      {R"({"type":"seek","to":-1})", "from 0 to"},
      {R"({"type":"seek","to":1e9})", "from 0 to"},
      {R"({"type":"seek","to":1e999})", "broken"},
      {R"({"type":"seek","to":null})", "its to is not a number"},
      {R"({"type":"scene","index":1.5})", "a whole number"},
      {R"({"type":"scene","index":99999999999999999999})", "index"},
      {R"({"type":"scene","index":-2})", "from -1"},
      {R"({"type":"throw","origin":[1,2],"target":[0,0,0]})", "its origin"},
      {R"({"type":"throw","origin":[1,2,1e6],"target":[0,0,0]})", "its origin"},
      {R"({"type":"throw","origin":[1,2,3],"target":[0,null,0]})", "its target"},
      {R"({"type":"press","origin":[1,2,3],"direction":[0,0,0],"forward":[0,0,1]})", "its direction"},
      {R"({"type":"drag","origin":[1,2,3],"direction":[0,0,1]})", "its forward"},
      {R"({"type":"release","hand":2})", "its hand is not 0 or 1"},
      {R"({"type":"release","hand":-1})", "its hand is not 0 or 1"},
      {R"({"type":"drag","hand":"left","origin":[1,2,3],"direction":[0,0,1],"forward":[0,0,1]})", "its hand"},
      {R"({"type":"release","velocity":[80,80,0]})", "its velocity"},
      {R"({"type":"release","velocity":[1,2]})", "its velocity"},
      {R"({"type":"head","time":"now","position":[0,1,0],"orientation":[0,0,0,1]})", "its time"},
      {R"({"type":"head","time":1,"position":[0,1],"orientation":[0,0,0,1]})", "its position"},
      {R"({"type":"head","time":1,"position":[0,1,0],"orientation":[0,0,0,0]})", "its orientation"},
      {R"({"type":"head","time":1,"position":[0,1,0],"orientation":[0,0,0,9]})", "its orientation"},
      {R"({"type":"head","time":1,"position":[0,1,0],"orientation":[0,0,0,1],"hands":[null]})", "its hands"},
      {R"({"type":"head","time":1,"position":[0,1,0],"orientation":[0,0,0,1],"hands":[null,7]})", "its position"},
      {R"({"type":"ack","frame":[[[[[1]]]]]})", "deeper"},
      {std::string(kMaxWishBytes + 1, ' '), "at most"}};
  for (const auto& [text, part] : rows) {
    const Result<Wish> wish = readWish(text);
    ASSERT_FALSE(wish.ok()) << text;
    EXPECT_NE(wish.error().message.find(part), std::string::npos) << text << ": " << wish.error().message;
  }
}

TEST(Wish, TruncatedMessagesAreRefused) {
  const std::string text = R"({"type":"press","origin":[0,1,0],"direction":[0,0,2],"forward":[3,0,4]})";
  for (std::size_t i = 0; i < text.size(); ++i) EXPECT_FALSE(readWish(text.substr(0, i)).ok()) << i;
}

}  // namespace
}  // namespace lorica
