#include "viewer/page/wire.h"

#include "geometry/convex_hull.h"
#include "geometry/little_endian.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/allocations.h"
#include "tests/support/value_of.h"
#include "viewer/page/client_message.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace lorica {
namespace {

using test::valueOf;
using Kind = ClientMessage::Kind;

/// A scene of one figure with joints and parts, and of boxes.
struct SmallScene {
  Skeleton skeleton = makeMannequin().skeleton;
  std::vector<Affine3> worldFromModel;
  std::vector<LivePart> parts;
  std::vector<Prop> props;
  std::vector<float> face = {0.25f, 1.0f};
  std::vector<Contact> contacts;
  std::vector<Vec3f> particles;

  explicit SmallScene(int joints = 60, int boxes = 100) {
    for (int j = 0; j < joints; ++j) {
      const Eigen::AngleAxisd turn(0.05 * j, Vec3(1, 2, 3).normalized());
      worldFromModel.push_back(Affine3(Eigen::Translation3d(0.1 * j, 1.0, -0.02 * j) * turn));
    }
    for (int p = 0; p < 2; ++p) {
      LivePart part;
      part.shape.vertices = {Vec3(0, 0, 0), Vec3(0.2, 0, 0), Vec3(0, 0.3, 0), Vec3(0, 0, -0.4)};
      part.shape.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
      part.worldFromPart = Isometry3(Eigen::Translation3d(p, 1, 0));
      parts.push_back(part);
    }
    for (int i = 0; i < boxes; ++i) {
      Prop prop;
      prop.worldFromProp.translation() = Vec3(i, 0.1, 0);
      props.push_back(prop);
    }
    contacts.push_back({0, 0, 3, kNoJoint, Vec3(1, 2, 3), Vec3::UnitY(), 0.01, 0.75});
    for (int i = 0; i < 50'000; ++i) particles.emplace_back(0.001f * i, 0.5f, -0.25f);
  }
  Scene scene() const {
    Scene made;
    made.number = 2;
    made.skeleton = &skeleton;
    made.worldFromModel = worldFromModel;
    made.parts = parts;
    made.expressions = face;
    made.opacity = 0.5f;
    made.props = props;
    made.contacts = contacts;
    made.particles = particles;
    made.particleRadius = 0.02f;
    made.time = 2.5;
    return made;
  }
};

template <typename T>
T at(const std::string& bytes, std::size_t offset) {
  return loadLittleEndian<T>(bytes.data() + offset);
}

/// The sections of a message by kind, as docs/WIRE.md says.
std::map<int, std::string> sectionsOf(const std::string& message) {
  std::map<int, std::string> sections;
  EXPECT_EQ(message.substr(0, 4), "LRCF");
  EXPECT_EQ(at<std::uint16_t>(message, 4), 1);
  std::size_t offset = 32;
  for (int i = 0; i < at<std::uint16_t>(message, 6); ++i) {
    const auto length = at<std::uint32_t>(message, offset + 4);
    sections[at<std::uint16_t>(message, offset)] = message.substr(offset + 8, length);
    offset += 8 + (length + 3) / 4 * 4;
  }
  EXPECT_EQ(offset, message.size());
  return sections;
}

Vec3 positionAt(const std::string& bytes, std::size_t offset) {
  return {at<float>(bytes, offset), at<float>(bytes, offset + 4), at<float>(bytes, offset + 8)};
}

Quat rotationAt(const std::string& bytes, std::size_t offset) {
  const auto part = [&](int i) { return at<std::int16_t>(bytes, offset + 12 + 2 * i) / 32767.0; };
  return Quat(part(3), part(0), part(1), part(2));
}

constexpr unsigned kAll = served::kHulls | served::kContacts | served::kParticles | served::kDepth | served::kFace;

struct Sender {
  ServedFrame frame;
  FrameEncoder encoder;

  std::string send(const Scene& scene, ClientMemory& client, unsigned layers = kAll) {
    frame.run = 7;
    frame.take(scene, kAll);
    encoder.encode(frame);
    std::string message;
    encoder.compose(9, layers, 0.0, client, message);
    return message;
  }
};

TEST(Wire, AFrameHoldsTheScene) {
  const SmallScene small;
  Sender sender;
  ClientMemory client;
  const std::string message = sender.send(small.scene(), client);
  EXPECT_EQ(at<std::uint32_t>(message, 8), 7u);
  EXPECT_EQ(at<std::uint32_t>(message, 12), sender.encoder.propsVersion());
  EXPECT_EQ(at<std::uint64_t>(message, 16), 9u);
  EXPECT_EQ(at<double>(message, 24), 2.5);
  std::map<int, std::string> sections = sectionsOf(message);
  ASSERT_EQ(sections.size(), 6u);  // all but the depth image

  const std::string& avatar = sections[1];
  ASSERT_EQ(avatar.size(), 8 + 20 * small.worldFromModel.size());
  EXPECT_EQ(at<std::uint16_t>(avatar, 2), small.worldFromModel.size());
  EXPECT_EQ(at<float>(avatar, 4), 0.5f);
  for (std::size_t j = 0; j < small.worldFromModel.size(); ++j) {
    const Affine3& joint = small.worldFromModel[j];
    EXPECT_LT((positionAt(avatar, 8 + 20 * j) - joint.translation()).norm(), 1e-6);
    EXPECT_LT(rotationAt(avatar, 8 + 20 * j).angularDistance(Quat(joint.linear())), 1e-4);
  }
  EXPECT_EQ(at<float>(sections[2], 0), 0.25f);
  EXPECT_EQ(at<std::uint32_t>(sections[3], 0), 100u);
  EXPECT_EQ(positionAt(sections[3], 4 + 24 * 42 + 4).x(), 42.0);

  const std::string& hulls = sections[4];
  ASSERT_EQ(hulls.size(), 4u + 2 * (32 + 4 * 6 + 4 * 6));
  const float extent = at<float>(hulls, 4 + 20);
  EXPECT_FLOAT_EQ(extent, 0.4f);
  for (int v = 0; v < 4; ++v) {
    for (int c = 0; c < 3; ++c) {
      const double coordinate = at<std::int16_t>(hulls, 4 + 32 + 6 * v + 2 * c) * extent / 32767.0;
      EXPECT_NEAR(coordinate, small.parts[0].shape.vertices[v][c], extent / 32767.0);
    }
  }
  EXPECT_EQ(positionAt(sections[5], 4), Vec3(1, 2, 3));
  EXPECT_EQ(at<float>(sections[5], 28), 0.75f);

  const std::string& grains = sections[6];
  EXPECT_EQ(at<std::uint32_t>(grains, 0), 50'000u);
  const auto sent = at<std::uint32_t>(grains, 4);
  EXPECT_LE(sent, kMaxServedParticles);
  EXPECT_GT(sent, kMaxServedParticles / 2);
  const Vec3 lowest = positionAt(grains, 16), size = positionAt(grains, 28);
  const double x = lowest.x() + size.x() * at<std::uint16_t>(grains, 40 + 6) / 65535.0;
  EXPECT_NEAR(x, 0.003, 1e-3);  // each third of them
}

TEST(Wire, OnlyWhatIsNewIsSentAgain) {
  SmallScene small;
  Sender sender;
  ClientMemory client;
  const std::string first = sender.send(small.scene(), client);
  std::map<int, std::string> sections = sectionsOf(sender.send(small.scene(), client));
  EXPECT_EQ(at<std::uint32_t>(sections[3], 0), 0u);
  EXPECT_EQ(at<std::uint16_t>(sections[4], 4 + 28), 4);
  EXPECT_EQ(at<std::uint16_t>(sections[4], 4 + 30), 0) << "faces that this client has";
  std::string message;
  sender.encoder.compose(10, kAll, 0.0, client, message);
  EXPECT_EQ(at<std::uint16_t>(sectionsOf(message)[4], 4 + 28), 0) << "and its shape, too";
  small.props[5].worldFromProp.translation().y() = 1.0;
  small.parts[1].shape.triangles.pop_back();
  sections = sectionsOf(sender.send(small.scene(), client));
  EXPECT_EQ(at<std::uint32_t>(sections[3], 0), 1u);
  EXPECT_EQ(at<std::uint16_t>(sections[3], 4), 5);
  EXPECT_EQ(at<std::uint16_t>(sections[4], 4 + 30), 0);
  EXPECT_EQ(at<std::uint16_t>(sections[4], 4 + 32 + 24 + 30), 3);
  ClientMemory other;
  EXPECT_EQ(at<std::uint32_t>(sectionsOf(sender.send(small.scene(), other))[3], 0), 100u);
}

TEST(Wire, OneWhoSawHullsBeforeGetsFacesAgainAfterAPause) {
  const SmallScene small;
  Sender sender;
  ClientMemory client;
  (void)sender.send(small.scene(), client);
  EXPECT_EQ(sectionsOf(sender.send(small.scene(), client, 0)).count(4), 0u);
  EXPECT_EQ(at<std::uint16_t>(sectionsOf(sender.send(small.scene(), client))[4], 4 + 30), 4);
}

TEST(Wire, JointsThatAreScaledAreSentAsMatrices) {
  SmallScene small;
  small.worldFromModel[3].linear() *= 1.5;
  Sender sender;
  ClientMemory client;
  const std::string avatar = sectionsOf(sender.send(small.scene(), client))[1];
  ASSERT_EQ(avatar.size(), 8 + 48 * small.worldFromModel.size());
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      EXPECT_EQ(at<float>(avatar, 8 + 48 * 3 + 16 * row + 4 * column),
                static_cast<float>(small.worldFromModel[3](row, column)));
    }
  }
}

TEST(Wire, AnAvatarAndAHundredPropsTakeAtMostTwelveKilobytes) {
  const SmallScene small(200, 100);
  Sender sender;
  ClientMemory client;
  EXPECT_LE(sender.send(small.scene(), client, served::kFace | served::kContacts).size(), 12'000u);
}

TEST(Wire, PropsAreDescribedAgainWhenOneIsAnother) {
  SmallScene small(10, 2);
  Sender sender;
  ClientMemory client;
  (void)sender.send(small.scene(), client);
  const std::uint32_t version = sender.encoder.propsVersion();
  small.props[0].worldFromProp.translation().x() += 1.0;
  (void)sender.send(small.scene(), client);
  EXPECT_EQ(sender.encoder.propsVersion(), version);
  Prop ball;
  ball.shape = PropShape::kSphere;
  ball.mass = 0.0;
  small.props.push_back(ball);
  (void)sender.send(small.scene(), client);
  EXPECT_EQ(sender.encoder.propsVersion(), version + 1);
  const nlohmann::json props = nlohmann::json::parse(sender.encoder.propsText());
  EXPECT_EQ(props["props"].size(), 3u);
  EXPECT_EQ(props["props"][2]["shape"], "sphere");
  EXPECT_EQ(props["props"][2]["fixed"], true);
}

TEST(Wire, MeshesOfPropsAreSharedAndServed) {
  const auto shape = std::make_shared<PropMeshShape>();
  shape->shown.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  shape->shown.triangles = {{0, 1, 2}};
  SmallScene small(10, 0);
  Prop prop;
  prop.shape = PropShape::kMesh;
  prop.mesh = shape;
  small.props = {prop, prop};
  Sender sender;
  ClientMemory client;
  (void)sender.send(small.scene(), client);
  const nlohmann::json props = nlohmann::json::parse(sender.encoder.propsText());
  EXPECT_EQ(props["props"][0]["mesh"], 0);
  EXPECT_EQ(props["props"][1]["mesh"], 0);
  ASSERT_NE(sender.encoder.mesh(0), nullptr);
  EXPECT_EQ(sender.encoder.mesh(0)->size(), 8u + 3 * 12 + 12);
  EXPECT_EQ(sender.encoder.mesh(1), nullptr);
}

TEST(Wire, ADepthImageComesTenTimesASecond) {
  const SmallScene small(10, 0);
  Image image{16, 8, std::vector<std::uint8_t>(16 * 8 * 4, 128)};
  Scene scene = small.scene();
  scene.inset = &image;
  Sender sender;
  ClientMemory client;
  const std::string jpeg = sectionsOf(sender.send(scene, client))[7];
  EXPECT_EQ(jpeg.substr(0, 2), "\xff\xd8");
  std::string message;
  sender.encoder.compose(10, kAll, 0.05, client, message);
  EXPECT_EQ(sectionsOf(message).count(7), 0u);
  message.clear();
  sender.encoder.compose(11, kAll, 0.11, client, message);
  EXPECT_EQ(sectionsOf(message).count(7), 1u);
}

TEST(Wire, TakingASceneAllocatesNothingOnceItWasSeen) {
  const SmallScene small;
  const Scene scene = small.scene();
  ServedFrame frame;
  frame.take(scene, kAll);
  const long before = test::allocationCount();
  frame.take(scene, kAll);
  EXPECT_EQ(test::allocationCount(), before);
}

TEST(ClientMessage, MessagesAreRead) {
  EXPECT_EQ(valueOf(readClientMessage(R"({"type":"ack","frame":12345678901234})")).frame, 12345678901234u);
  EXPECT_EQ(valueOf(readClientMessage(R"({"type":"show","layers":["hulls","depth"]})")).layers,
            served::kHulls | served::kDepth);
  EXPECT_EQ(valueOf(readClientMessage(R"({"type":"show","layers":[]})")).layers, 0u);
  const auto setBy = [](const char* text) { return valueOf(readClientMessage(text)).change; };
  EXPECT_EQ(setBy(R"({"set":"pause","to":true})").id, ControlId::kPause);
  EXPECT_EQ(setBy(R"({"set":"pause","to":true})").to, 1.0);
  EXPECT_EQ(setBy(R"({"set":"pause","to":false})").to, 0.0);
  EXPECT_EQ(setBy(R"({"set":"seek","to":1.5})").to, 1.5);
  EXPECT_EQ(setBy(R"({"set":"expression","to":-1})").to, -1.0);
  EXPECT_EQ(setBy(R"({"set":"parts","by":-2})").by, -2.0);
  EXPECT_FALSE(setBy(R"({"set":"parts","by":-2})").to);
  const Change undo = setBy(R"({"set":"undo","more":"is ignored"})");
  EXPECT_EQ(undo.id, ControlId::kUndo);
  EXPECT_EQ(undo.by, 1.0);
  const Change thrown = valueOf(readClientMessage(R"({"type":"throw","origin":[1,2,3],"target":[-4,5.5,6]})")).change;
  EXPECT_EQ(thrown.ray.origin, Vec3(1, 2, 3));
  EXPECT_EQ(thrown.at, Vec3(-4, 5.5, 6));
  const ClientMessage press =
      valueOf(readClientMessage(R"({"type":"press","origin":[0,1,0],"direction":[0,0,2],"forward":[3,0,4]})"));
  EXPECT_EQ(press.aim.ray.direction, Vec3::UnitZ());
  EXPECT_TRUE(press.aim.forward.isApprox(Vec3(0.6, 0.0, 0.8)));
  EXPECT_EQ(press.change.hand, 0) << "without a number it is the first";
  EXPECT_EQ(
      valueOf(readClientMessage(R"({"type":"drag","hand":1,"origin":[0,1,0],"direction":[0,0,2],"forward":[3,0,4]})"))
          .change.hand,
      1);
  const Change release = valueOf(readClientMessage(R"({"type":"release","hand":1,"velocity":[3,0,-4]})")).change;
  EXPECT_EQ(release.hand, 1);
  EXPECT_EQ(release.velocity, Vec3(3, 0, -4));
  EXPECT_EQ(valueOf(readClientMessage(R"({"type":"release"})")).change.velocity, Vec3::Zero());
  const ClientMessage head =
      valueOf(readClientMessage(R"({"type":"head","time":12.5,"position":[0,1.6,0],"orientation":[0,0.6,0,0.8]})"));
  EXPECT_EQ(head.pose.time, 12.5);
  EXPECT_EQ(head.pose.head.translation(), Vec3(0.0, 1.6, 0.0));
  EXPECT_TRUE(head.pose.head.linear().isApprox(Quat(0.8, 0.0, 0.6, 0.0).toRotationMatrix()));
  EXPECT_FALSE(head.pose.hands[0] || head.pose.hands[1]);
  const ClientMessage hands =
      valueOf(readClientMessage(R"({"type":"head","time":1,"position":[0,1,0],"orientation":[0,0,0,1],
      "hands":[null,{"position":[0.3,1,-0.2],"orientation":[0,0,1,0]}]})"));
  EXPECT_FALSE(hands.pose.hands[0]);
  ASSERT_TRUE(hands.pose.hands[1]);
  EXPECT_EQ(hands.pose.hands[1]->translation(), Vec3(0.3, 1.0, -0.2));
}

TEST(ClientMessage, WhatIsNoMessageIsRefusedWithASentence) {
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
      {R"({"type":"pause"})", "no type that Lorica knows"},
      {R"({"set":"shutdown"})", "no control of this name"},
      {R"({"set":7})", "no control of this name"},
      {R"({"set":"pause","to":"on"})", "its to is not true, false, or a number"},
      {R"({"set":"seek","to":1e9})", "from -1,000,000"},
      {R"({"set":"seek","to":1e999})", "broken"},
      {R"({"set":"seek","to":null})", "its to is not true"},
      {R"({"set":"seek","by":[1]})", "its by is not true"},
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
      {std::string(kMaxMessageBytes + 1, ' '), "at most"}};
  for (const auto& [text, part] : rows) {
    const Result<ClientMessage> message = readClientMessage(text);
    ASSERT_FALSE(message.ok()) << text;
    EXPECT_NE(message.error().message.find(part), std::string::npos) << text << ": " << message.error().message;
  }
}

/// What each page has for itself is not that of the machine that serves.
TEST(ClientMessage, SetsWhatPagesShare) {
  for (const Control& control : control_rows::kRows) {
    const std::string text = std::string(R"({"set":")") + control.name + "\"}";
    EXPECT_EQ(readClientMessage(text).ok(), control.isOn(on_screen::kPage) && !control.isOn(on_screen::kOwn)) << text;
  }
  for (const char* name : {"hulls", "help", "picture", "recent", "followed", "press", "release", "find"}) {
    EXPECT_FALSE(readClientMessage(std::string(R"({"set":")") + name + "\"}").ok()) << name;
  }
}

TEST(ClientMessage, TruncatedMessagesAreRefused) {
  const std::string text = R"({"type":"press","origin":[0,1,0],"direction":[0,0,2],"forward":[3,0,4]})";
  for (std::size_t i = 0; i < text.size(); ++i) EXPECT_FALSE(readClientMessage(text.substr(0, i)).ok()) << i;
}

}  // namespace
}  // namespace lorica
