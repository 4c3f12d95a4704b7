#include "serve/page_screen.h"

#include "skinning/mannequin/mannequin.h"
#include "tests/serve/test_client.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace lorica {
namespace {

using test::becomes;
using test::TestClient;
using test::valueOf;
using Json = nlohmann::json;

struct Watched {
  std::unique_ptr<PageServer> server = valueOf(PageServer::start({}));
  PageScreen screen{*server, nullptr};
  std::vector<std::string> scenes = {"boxes", "bowling"}, characters = {"/home/somebody/hero.glb", "mannequin"};
  WindowValues values;

  Watched() {
    values.scenes = scenes;
    values.characters = characters;
    values.maxParts = 64;
    screen.show(Scene(), values);
  }
  /// The first requests that are any.
  WindowRequests requests(const std::function<bool(const WindowRequests&)>& any) {
    WindowRequests last;
    EXPECT_TRUE(becomes([&] {
      last = screen.takeRequests();
      return any(last);
    }));
    return last;
  }
};

Json ray(const char* type, double x) {
  return {{"type", type}, {"origin", {x, 1, 0}}, {"direction", {0, 0, -1}}, {"forward", {0, 0, -1}}};
}

TEST(PageScreen, ClientsChooseAsPeopleAtAWindowDo) {
  Watched watched;
  TestClient client(watched.server->port());
  client.watch();
  client.send({{"type", "pause"}, {"on", true}});
  EXPECT_TRUE(becomes([&] {
    (void)watched.screen.takeRequests();
    return watched.screen.choices().paused;
  }));
  EXPECT_FALSE(watched.screen.wantsStep());
  client.send({{"type", "step"}});
  EXPECT_TRUE(becomes([&] {
    (void)watched.screen.takeRequests();
    return watched.screen.wantsStep();
  }));
  EXPECT_FALSE(watched.screen.wantsStep());
  for (const Json& wish : {Json{{"type", "speed"}, {"to", 0.5}}, Json{{"type", "gravity"}, {"index", 1}},
                           Json{{"type", "mirror"}, {"on", true}}, Json{{"type", "loop"}, {"on", false}}}) {
    client.send(wish);
  }
  EXPECT_TRUE(becomes([&] {
    (void)watched.screen.takeRequests();
    return !watched.screen.choices().loop;
  }));
  EXPECT_EQ(watched.screen.choices().speed, 0.5);
  EXPECT_EQ(watched.screen.choices().treatment.gravity, 1);
  EXPECT_TRUE(watched.screen.choices().treatment.mirror);

  client.send({{"type", "scene"}, {"index", 1}});
  EXPECT_EQ(*watched.requests([](const WindowRequests& r) { return r.scene.has_value(); }).scene, 1);
  client.send({{"type", "character"}, {"index", 0}});
  EXPECT_EQ(watched.requests([](const WindowRequests& r) { return !r.files.empty(); }).files,
            std::vector<std::string>{"/home/somebody/hero.glb"});
  client.send({{"type", "parts"}, {"count", 24}});
  EXPECT_EQ(*watched.requests([](const WindowRequests& r) { return r.parts.has_value(); }).parts, 24);
  for (const bool on : {true, false}) {
    client.send({{"type", "record"}, {"on", on}});
    EXPECT_EQ(*watched.requests([](const WindowRequests& r) { return r.record.has_value(); }).record, on);
  }
}

TEST(PageScreen, WhatIsNotInAListIsNotOpened) {
  Watched watched;
  TestClient client(watched.server->port());
  client.watch();
  for (const Json& wish :
       {Json{{"type", "scene"}, {"index", 2}}, Json{{"type", "scene"}, {"index", -1}},
        Json{{"type", "character"}, {"index", 2}}, Json{{"type", "motion"}, {"index", 0}},
        Json{{"type", "clip"}, {"index", 0}}, Json{{"type", "person"}, {"index", 0}},
        Json{{"type", "gravity"}, {"index", 9}}, Json{{"type", "smoothing"}, {"index", 9}},
        Json{{"type", "speed"}, {"to", 3.0}}, Json{{"type", "parts"}, {"count", 65}}, Json{{"type", "undo"}}}) {
    client.send(wish);
  }
  const WindowChoices before = watched.screen.choices();
  const WindowRequests last = watched.requests([](const WindowRequests& r) {
    EXPECT_FALSE(r.scene || r.clip || r.person || r.parts || !r.files.empty());
    return r.undo;
  });
  EXPECT_TRUE(before == static_cast<const KeptChoices&>(watched.screen.choices()));
  EXPECT_EQ(watched.screen.choices().speed, 1.0);
}

TEST(PageScreen, OneHoldsAndTheOthersWait) {
  Watched watched;
  TestClient one(watched.server->port()), other(watched.server->port());
  one.watch();
  other.watch();
  one.send(ray("press", 1.0));
  const WindowRequests pressed = watched.requests([](const WindowRequests& r) { return r.pressed.has_value(); });
  EXPECT_EQ(pressed.pressed->origin, Vec3(1, 1, 0));
  EXPECT_EQ(watched.screen.pointer().origin, Vec3(1, 1, 0));
  EXPECT_EQ(watched.screen.camera().target, Vec3(1, 1, -1));
  watched.values.holdsProp = true;
  watched.screen.show(Scene(), watched.values);
  other.send(ray("press", 5.0));
  other.send(ray("drag", 5.0));
  other.send({{"type", "release"}});
  other.send({{"type", "undo"}});
  (void)watched.requests([](const WindowRequests& r) {
    EXPECT_FALSE(r.pressed || r.released);
    return r.undo;
  });
  one.send(ray("drag", 2.0));
  EXPECT_TRUE(becomes([&] {
    (void)watched.screen.takeRequests();
    return watched.screen.pointer().origin == Vec3(2, 1, 0);
  }));
  one.send({{"type", "release"}});
  (void)watched.requests([](const WindowRequests& r) { return r.released; });
  watched.values.holdsProp = false;
  watched.screen.show(Scene(), watched.values);
  other.send(ray("press", 5.0));
  EXPECT_EQ(watched.requests([](const WindowRequests& r) { return r.pressed.has_value(); }).pressed->origin.x(), 5.0);
}

TEST(PageScreen, EachThrowHasItsOwnCamera) {
  Watched watched;
  TestClient client(watched.server->port());
  client.watch();
  for (const double x : {1.0, 2.0}) {
    client.send({{"type", "throw"}, {"origin", {x, 1, 5}}, {"target", {x, 1, 0}}});
  }
  for (const double x : {1.0, 2.0}) {
    (void)watched.requests([](const WindowRequests& r) { return r.throwBall; });
    EXPECT_EQ(watched.screen.camera().eye, Vec3(x, 1, 5));
    EXPECT_EQ(watched.screen.camera().target, Vec3(x, 1, 0));
  }
}

TEST(PageScreen, TheStateNamesFilesWithoutTheirFolders) {
  Watched watched;
  TestClient client(watched.server->port());
  client.watch();
  EXPECT_TRUE(becomes([&] { return watched.server->clients() == 1; }));
  watched.screen.show(Scene(), watched.values);
  const std::string state = client.next("state").bytes;
  EXPECT_EQ(Json::parse(state)["characters"], Json({"hero.glb", "mannequin"}));
  EXPECT_EQ(state.find("somebody"), std::string::npos);
}

}  // namespace
}  // namespace lorica
