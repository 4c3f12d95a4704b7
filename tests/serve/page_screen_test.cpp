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
using test::Watcher;
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
  /// Whether it becomes so as requests are taken.
  bool comes(const std::function<bool()>& so) {
    return becomes([&] {
      (void)screen.takeRequests();
      return so();
    });
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

Json ray(const char* type, double x, int hand = 0) {
  return {{"type", type}, {"hand", hand}, {"origin", {x, 1, 0}}, {"direction", {0, 0, -1}}, {"forward", {0, 0, -1}}};
}

TEST(PageScreen, ClientsChooseAsPeopleAtAWindowDo) {
  Watched watched;
  Watcher client(watched.server->port());
  client.send({{"type", "pause"}, {"on", true}});
  EXPECT_TRUE(watched.comes([&] { return watched.screen.choices().paused; }));
  EXPECT_FALSE(watched.screen.wantsStep());
  client.send({{"type", "step"}});
  EXPECT_TRUE(watched.comes([&] { return watched.screen.wantsStep(); }));
  EXPECT_FALSE(watched.screen.wantsStep());
  for (const Json& wish : {Json{{"type", "speed"}, {"to", 0.5}}, Json{{"type", "gravity"}, {"index", 1}},
                           Json{{"type", "mirror"}, {"on", true}}, Json{{"type", "loop"}, {"on", false}}}) {
    client.send(wish);
  }
  EXPECT_TRUE(watched.comes([&] { return !watched.screen.choices().loop; }));
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
  Watcher client(watched.server->port());
  for (const Json& wish :
       {Json{{"type", "scene"}, {"index", 2}}, Json{{"type", "scene"}, {"index", -1}},
        Json{{"type", "character"}, {"index", 2}}, Json{{"type", "motion"}, {"index", 0}},
        Json{{"type", "clip"}, {"index", 0}}, Json{{"type", "person"}, {"index", 0}},
        Json{{"type", "gravity"}, {"index", 9}}, Json{{"type", "smoothing"}, {"index", 9}},
        Json{{"type", "gravity"}, {"index", -1}}, Json{{"type", "smoothing"}, {"index", -1}},
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

/// Presses of clients become grabs, as a session does it. @return the hand that the world knows it by
int pressed(Watched& watched, TestClient& client, double x, int hand) {
  client.send(ray("press", x, hand));
  int found = -1;
  (void)watched.requests([&](const WindowRequests& r) {
    for (int i = 0; i < World::kMaxHands; ++i) {
      if (!r.hands[i].pressed) continue;
      EXPECT_EQ(r.hands[i].pressed->origin, Vec3(x, 1, 0));
      found = i;
    }
    return found >= 0;
  });
  if (found < 0) return 0;
  EXPECT_EQ(watched.values.holds >> found & 1u, 0u) << "it is another one's hand";
  watched.values.holds |= 1u << found;
  watched.screen.show(Scene(), watched.values);
  return found;
}

/// Takes requests until one hand lets go, and no other. @return with which velocity
Vec3 letsGo(Watched& watched, int hand) {
  const WindowRequests requests =
      watched.requests([&](const WindowRequests& r) { return r.hands[hand].released || r.undo; });
  for (int i = 0; i < World::kMaxHands; ++i) EXPECT_EQ(requests.hands[i].released, i == hand) << i;
  watched.values.holds &= ~(1u << hand);
  watched.screen.show(Scene(), watched.values);
  return requests.hands[hand].throwsWith;
}

TEST(PageScreen, HandsOfClientsDoNotDisturbEachOther) {
  Watched watched;
  Watcher one(watched.server->port()), other(watched.server->port());
  std::vector<int> hands;
  for (TestClient* client : {&one, &other}) {
    for (const int hand : {0, 1}) hands.push_back(pressed(watched, *client, 1.0 + std::ssize(hands), hand));
  }
  const auto aims = [&] {
    std::vector<double> x;
    for (const int hand : hands) x.push_back(watched.screen.aim(hand).ray.origin.x());
    return x;
  };
  EXPECT_EQ(aims(), (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(watched.screen.aim(hands[1]).forward, Vec3(0, 0, -1));
  other.send(ray("drag", 30.0, 0));
  one.send(ray("drag", 20.0, 1));
  EXPECT_TRUE(watched.comes([&] { return aims() == std::vector<double>{1, 20, 30, 4}; }));
  one.send({{"type", "release"}, {"hand", 1}, {"velocity", {0, 2, -3}}});
  EXPECT_EQ(letsGo(watched, hands[1]), Vec3(0, 2, -3));
  one.send({{"type", "release"}, {"hand", 1}});  // it holds nothing any more
  one.send({{"type", "undo"}});
  (void)watched.requests([](const WindowRequests& r) {
    for (const HandRequests& hand : r.hands) EXPECT_FALSE(hand.released || hand.pressed);
    return r.undo;
  });
  EXPECT_EQ(aims()[3], 4.0);
}

TEST(PageScreen, WhatAClientHoldsIsLetGoWhenItLeaves) {
  Watched watched;
  Watcher stays(watched.server->port());
  const int kept = pressed(watched, stays, 1.0, 0);
  std::vector<int> hands;
  {
    Watcher leaves(watched.server->port());
    for (const int hand : {0, 1}) hands.push_back(pressed(watched, leaves, 2.0 + hand, hand));
  }
  const WindowRequests requests = watched.requests([&](const WindowRequests& r) { return r.hands[hands[0]].released; });
  EXPECT_TRUE(requests.hands[hands[1]].released);
  EXPECT_FALSE(requests.hands[kept].released);
  watched.values.holds = 1u << kept;
  watched.screen.show(Scene(), watched.values);
  Watcher next(watched.server->port());
  EXPECT_NE(pressed(watched, next, 5.0, 1), kept);
}

/// What is let go while something loads is not forgotten.
TEST(PageScreen, AReleaseOutlastsWhatLoads) {
  Watched watched;
  Watcher client(watched.server->port());
  const int hand = pressed(watched, client, 1.0, 0);
  client.send({{"type", "undo"}});
  client.send({{"type", "release"}});
  client.send({{"type", "cancel"}});
  EXPECT_TRUE(becomes([&] { return watched.screen.takeCancel(); }));
  const WindowRequests requests = watched.screen.takeRequests();
  EXPECT_TRUE(requests.hands[hand].released);
  EXPECT_FALSE(requests.undo);
}

TEST(PageScreen, NoMoreHandsHoldThanTheWorldHas) {
  Watched watched;
  std::vector<std::unique_ptr<Watcher>> clients;
  for (int i = 0; i <= World::kMaxHands; ++i) {
    if (i % 2 == 0) clients.push_back(std::make_unique<Watcher>(watched.server->port()));
    if (i < World::kMaxHands) pressed(watched, *clients.back(), i, i % 2);
  }
  clients.back()->send(ray("press", 90.0));
  clients.back()->send({{"type", "undo"}});
  (void)watched.requests([](const WindowRequests& r) {
    for (const HandRequests& hand : r.hands) EXPECT_FALSE(hand.pressed);
    return r.undo;
  });
}

TEST(PageScreen, EachThrowHasItsOwnCamera) {
  Watched watched;
  Watcher client(watched.server->port());
  for (const double x : {1.0, 2.0}) {
    client.send({{"type", "throw"}, {"origin", {x, 1, 5}}, {"target", {x, 1, 0}}});
  }
  for (const double x : {1.0, 2.0}) {
    const WindowRequests requests = watched.requests([](const WindowRequests& r) { return r.throwBall; });
    EXPECT_EQ(requests.thrower->eye, Vec3(x, 1, 5));
    EXPECT_EQ(requests.thrower->target, Vec3(x, 1, 0));
  }
}

TEST(PageScreen, TheStateNamesFilesWithoutTheirFolders) {
  Watched watched;
  Watcher client(watched.server->port());
  EXPECT_TRUE(becomes([&] { return watched.server->clients() == 1; }));
  watched.screen.show(Scene(), watched.values);
  const std::string state = client.next("state").bytes;
  EXPECT_EQ(Json::parse(state)["characters"], Json({"hero.glb", "mannequin"}));
  EXPECT_EQ(state.find("somebody"), std::string::npos);
}

}  // namespace
}  // namespace lorica
