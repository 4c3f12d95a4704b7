#include "viewer/page/page_screen.h"

#include "skinning/mannequin/mannequin.h"
#include "tests/support/value_of.h"
#include "tests/viewer/page/test_client.h"
#include "viewer/page/page_files.h"
#include "viewer/renderer/window_values.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
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
  Controls controls;
  WindowValues values;

  Watched() {
    values.controls = &controls;
    show();
  }
  /// As a run that has these.
  void show() {
    listChoices(screen.choices(), controls);
    controls.offer(ControlId::kScene).choices = scenes;
    controls.offer(ControlId::kCharacter).choices = characters;
    screen.show(Scene(), values);
  }
  /// Whether it becomes so as requests are taken.
  bool comes(const std::function<bool()>& so) {
    return becomes([&] {
      (void)screen.takeChanges();
      return so();
    });
  }
  /// The first changes among which is one of a control, and this one.
  std::pair<std::vector<Change>, Change> changes(ControlId id) {
    std::pair<std::vector<Change>, Change> last;
    EXPECT_TRUE(becomes([&] {
      last.first = screen.takeChanges();
      const auto found = std::ranges::find(last.first, id, &Change::id);
      if (found == last.first.end()) return false;
      last.second = *found;
      return true;
    }));
    return last;
  }
  Change change(ControlId id) { return changes(id).second; }
};

Json ray(const char* type, double x, int hand = 0) {
  return {{"type", type}, {"hand", hand}, {"origin", {x, 1, 0}}, {"direction", {0, 0, -1}}, {"forward", {0, 0, -1}}};
}

/// The window has the page's colours: those of page.css by the same names, in light and dark.
TEST(Page, HasTheColoursOfTheWindow) {
  const PageFile* file = pageFile("/page.css");
  if (!pageBuilt()) GTEST_SKIP() << "the page is not built (node and npm)";
  ASSERT_NE(file, nullptr);
  const std::string css(reinterpret_cast<const char*>(file->bytes.data()), file->bytes.size());
  std::size_t from = 0;
  for (const PanelColors& colors : {kLightPanels, kDarkPanels}) {
    const std::pair<const char*, std::uint32_t> all[] = {{"text", colors.text},          {"faint", colors.faint},
                                                         {"panel", colors.panel},        {"raised", colors.raised},
                                                         {"line", colors.line},          {"strong", colors.strong},
                                                         {"on-strong", colors.onStrong}, {"warn", colors.warn},
                                                         {"warn-text", colors.warnText}, {"bad", colors.bad},
                                                         {"bad-text", colors.badText}};
    for (const auto& [name, color] : all) {
      const std::string key = fmt::format("--{}:", name);
      const std::size_t at = css.find(key, from);
      ASSERT_NE(at, std::string::npos) << key;
      const std::size_t begin = css.find('#', at) + 1, end = css.find_first_not_of("0123456789abcdef", begin);
      std::string digits = css.substr(begin, end - begin);
      if (digits.size() == 3) digits = {digits[0], digits[0], digits[1], digits[1], digits[2], digits[2]};
      if (digits.size() == 6) digits += "ff";
      EXPECT_EQ(digits, fmt::format("{:08x}", color)) << key;
    }
    from = css.find("dark)");  // the second rule
  }
}

TEST(PageScreen, ClientsChooseAsPeopleAtAWindowDo) {
  Watched watched;
  Watcher client(watched.server->port());
  client.send({{"set", "pause"}, {"to", true}});
  EXPECT_TRUE(watched.comes([&] { return watched.screen.choices().paused; }));
  EXPECT_FALSE(watched.screen.wantsStep());
  client.send({{"set", "step"}});
  EXPECT_TRUE(watched.comes([&] { return watched.screen.wantsStep(); }));
  EXPECT_FALSE(watched.screen.wantsStep());
  for (const Json& message : {Json{{"set", "speed"}, {"to", 1}}, Json{{"set", "gravity"}, {"to", 1}},
                              Json{{"set", "mirror"}, {"to", true}}, Json{{"set", "loop"}, {"by", 1}}}) {
    client.send(message);
  }
  EXPECT_TRUE(watched.comes([&] { return !watched.screen.choices().loop; }));
  EXPECT_EQ(watched.screen.choices().speedFactor(), 0.5);
  EXPECT_EQ(watched.screen.choices().treatment.gravity, 1);
  EXPECT_TRUE(watched.screen.choices().treatment.mirror);

  client.send({{"set", "scene"}, {"to", 1}});
  EXPECT_EQ(watched.change(ControlId::kScene).to, 1.0);
  client.send({{"set", "parts"}, {"to", 24}});
  EXPECT_EQ(watched.change(ControlId::kParts).to, 24.0);
  for (const bool on : {true, false}) {
    client.send({{"set", "record"}, {"to", on}});
    EXPECT_EQ(watched.change(ControlId::kRecord).to, on ? 1.0 : 0.0);
  }
}

/// Nor does a page open a dialogue of the machine that serves.
TEST(PageScreen, WhatIsNotInAListIsNotChosen) {
  Watched watched;
  Watcher client(watched.server->port());
  for (const Json& message :
       {Json{{"set", "open"}}, Json{{"set", "gravity"}, {"to", 9}}, Json{{"set", "gravity"}, {"to", -1}},
        Json{{"set", "smoothing"}, {"to", 9}}, Json{{"set", "speed"}, {"to", 0.5}}, Json{{"set", "undo"}}}) {
    client.send(message);
  }
  const KeptChoices kept = watched.screen.choices();
  EXPECT_EQ(watched.changes(ControlId::kUndo).first.size(), 1u);
  EXPECT_TRUE(kept == watched.screen.choices());
  EXPECT_EQ(watched.screen.choices().speedFactor(), 1.0);
}

/// Presses of clients become grabs, as a session does it. @return the hand that the world knows it by
int pressed(Watched& watched, TestClient& client, double x, int hand) {
  client.send(ray("press", x, hand));
  const Change press = watched.change(ControlId::kPress);
  EXPECT_EQ(press.ray.origin, Vec3(x, 1, 0));
  EXPECT_EQ(watched.values.holds >> press.hand & 1u, 0u) << "it is another one's hand";
  watched.values.holds |= 1u << press.hand;
  watched.show();
  return press.hand;
}

/// Takes changes until one hand lets go, and no other. @return with which velocity
Vec3 letsGo(Watched& watched, int hand) {
  const auto [all, release] = watched.changes(ControlId::kRelease);
  EXPECT_EQ(all.size(), 1u);
  EXPECT_EQ(release.hand, hand);
  watched.values.holds &= ~(1u << hand);
  watched.show();
  return release.velocity;
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
  one.send({{"set", "undo"}});
  EXPECT_EQ(watched.changes(ControlId::kUndo).first.size(), 1u);
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
  std::vector<int> released;
  for (const Change& change : watched.changes(ControlId::kRelease).first) released.push_back(change.hand);
  EXPECT_EQ(released, hands);
  watched.values.holds = 1u << kept;
  watched.show();
  Watcher next(watched.server->port());
  EXPECT_NE(pressed(watched, next, 5.0, 1), kept);
}

/// What is let go while something loads is not forgotten.
TEST(PageScreen, AReleaseOutlastsWhatLoads) {
  Watched watched;
  Watcher client(watched.server->port());
  const int hand = pressed(watched, client, 1.0, 0);
  client.send({{"set", "undo"}});
  client.send({{"type", "release"}});
  client.send({{"set", "cancel"}});
  EXPECT_TRUE(becomes([&] { return watched.screen.takeCancel(); }));
  const std::vector<Change> changes = watched.screen.takeChanges();
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_EQ(changes[0].id, ControlId::kRelease);
  EXPECT_EQ(changes[0].hand, hand);
}

TEST(PageScreen, NoMoreHandsHoldThanTheWorldHas) {
  Watched watched;
  std::vector<std::unique_ptr<Watcher>> clients;
  for (int i = 0; i <= World::kMaxHands; ++i) {
    if (i % 2 == 0) clients.push_back(std::make_unique<Watcher>(watched.server->port()));
    if (i < World::kMaxHands) pressed(watched, *clients.back(), i, i % 2);
  }
  clients.back()->send(ray("press", 90.0));
  clients.back()->send({{"set", "undo"}});
  EXPECT_EQ(watched.changes(ControlId::kUndo).first.size(), 1u);
}

TEST(PageScreen, EachThrowHasItsOwnCamera) {
  Watched watched;
  Watcher client(watched.server->port());
  for (const double x : {1.0, 2.0}) {
    client.send({{"type", "throw"}, {"origin", {x, 1, 5}}, {"target", {x, 1, 0}}});
  }
  for (const double x : {1.0, 2.0}) {
    const Change thrown = watched.change(ControlId::kThrow);
    EXPECT_EQ(thrown.ray.origin, Vec3(x, 1, 5));
    EXPECT_EQ(thrown.at, Vec3(x, 1, 0));
  }
}

TEST(PageScreen, ControlsNameFilesWithoutTheirFolders) {
  Watched watched;
  Watcher client(watched.server->port());
  EXPECT_TRUE(becomes([&] { return watched.server->clients() == 1; }));
  watched.show();
  const Json list = Json::parse(client.next("controls").bytes)["controls"];
  const auto found = std::ranges::find_if(list, [](const Json& control) { return control["id"] == "avatar"; });
  ASSERT_NE(found, list.end());
  EXPECT_EQ((*found)["choices"], Json({"hero.glb", "mannequin"}));
  EXPECT_EQ(list.dump().find("somebody"), std::string::npos);
}

/// Somebody who knows nothing but the list can draw it and use it.
TEST(PageScreen, EachControlOfThePageIsInTheListWithItsWordsAndKey) {
  Watched watched;
  Watcher client(watched.server->port());
  EXPECT_TRUE(becomes([&] { return watched.server->clients() == 1; }));
  watched.show();
  const Json list = Json::parse(client.next("controls").bytes)["controls"];
  std::size_t count = 0;
  for (const Control& control : control_rows::kRows) {
    if (!control.isOn(on_screen::kPage)) continue;
    ASSERT_LT(count, list.size());
    const Json& json = list[count++];
    EXPECT_EQ(json["id"], control.name);
    EXPECT_EQ(json["label"], control.label);
    EXPECT_EQ(json.value("keys", ""), control.keys);
    EXPECT_EQ(json.value("own", false), control.isOn(on_screen::kOwn));
  }
  EXPECT_EQ(count, list.size());
}

}  // namespace
}  // namespace lorica
