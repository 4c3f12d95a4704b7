#include "geometry/files.h"
#include "geometry/little_endian.h"
#include "session/prepare/cast.h"
#include "session/prepare/recorded_cast.h"
#include "skinning/linear_blend.h"
#include "tests/apps/mannequin_glb.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"
#include "tests/viewer/page/test_client.h"
#include "viewer/page/page_screen.h"
#include "viewer/player/run.h"
#include "viewer/player/window_opener.h"
#include "viewer/player/window_settings.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <openssl/sha.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>
#include <thread>
#include <vector>

namespace lorica {
namespace {

using test::becomes;
using test::TestClient;
using test::valueOf;
using test::Watcher;
using Json = nlohmann::json;

/// A folder of the test, and no choices that somebody has kept.
struct Home : test::TemporaryFolder {
  Home() { ::setenv("XDG_CONFIG_HOME", path().c_str(), 1); }
};

Cast walkingCast(Host& host) {
  CastRequest request;
  request.motion = "walk";
  request.reading.drawn = true;
  return valueOf(prepareCast(request, host));
}

/// What a client gets is what the same session computes by itself.
TEST(ServedRun, FramesHoldThePosesOfTheSession) {
  const Home home;
  Host host;
  RunSetting setting;
  setting.frames = 40;
  setting.atEnd = AtEnd::kReturn;
  setting.hurry = true;
  const auto alone = valueOf(lorica::Run::start(walkingCast(host), setting, host));
  std::map<double, std::vector<Affine3>> truth;  // world from model, by the session's time
  while (alone->session.frameCount() < setting.frames && valueOf(alone->session.step())) {
    std::vector<Affine3> joints(alone->session.worldFromJoint().size());
    computeWorldFromModel(alone->session.character(), alone->session.worldFromJoint(), joints);
    truth[alone->session.time()] = joints;
  }

  const auto run = valueOf(lorica::Run::start(walkingCast(host), setting, host));
  std::unique_ptr<PageServer> server = valueOf(PageServer::start({}));
  PageScreen screen(*server, nullptr);
  EXPECT_TRUE(screen.begin(*run, host));
  std::thread client([&] {
    Watcher watcher(server->port());
    const nlohmann::json hello = watcher.next("hello").json();
    EXPECT_EQ(hello["name"], "walk");
    EXPECT_EQ(hello["avatars"][0]["joints"].size(), run->session.character().jointFromModel.size());
    int seen = 0;
    for (;;) {
      const TestClient::Message frame = watcher.next("frame");
      if (frame.kind != 2) break;
      ++seen;
      const auto found = truth.find(loadLittleEndian<double>(frame.bytes.data() + 24));
      ASSERT_NE(found, truth.end());
      for (std::size_t j = 0; j < found->second.size(); ++j) {
        const char* pose = frame.bytes.data() + 32 + 8 + 8 + 20 * j;
        for (int c = 0; c < 3; ++c) {
          EXPECT_EQ(loadLittleEndian<float>(pose + 4 * c), static_cast<float>(found->second[j].translation()[c]));
        }
      }
      watcher.send({{"type", "ack"}, {"frame", frame.number()}});
    }
    EXPECT_GT(seen, 0);
  });
  EXPECT_TRUE(becomes([&] { return server->clients() == 1; }));
  Shown shown{&screen, {}, nullptr, {}};
  EXPECT_EQ(valueOf(play(*run, shown, host)), RunEnd::kOver);
  EXPECT_EQ(run->session.hash(), alone->session.hash()) << "watching changes nothing";
  // The client sees the end when the server goes.
  server.reset();
  client.join();
}

/// The hash that the sample in Python prints of the places of all joints.
std::string hashOf(const Session& session) {
  std::vector<Affine3> joints(session.worldFromJoint().size());
  computeWorldFromModel(session.character(), session.worldFromJoint(), joints);
  std::vector<Vec3f> places(joints.size());
  std::transform(joints.begin(), joints.end(), places.begin(),
                 [](const Affine3& joint) { return Vec3f(joint.translation().cast<float>()); });
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
  SHA256(reinterpret_cast<const unsigned char*>(places.data()), places.size() * sizeof(Vec3f), digest.data());
  return fmt::format("{:02x}", fmt::join(digest.begin(), digest.begin() + 8, ""));
}

/// What the sample in Python decodes is what the session records.
TEST(ServedRun, TheSampleInPythonGetsWhatIsRecorded) {
  if (std::system("python3 --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "python3 is missing";
  const Home home;
  Host host;
  RunSetting setting;
  setting.frames = 60;
  setting.atEnd = AtEnd::kReturn;
  setting.record = home.path() / "served.lsession";
  const auto run = valueOf(lorica::Run::start(walkingCast(host), setting, host));
  std::unique_ptr<PageServer> server = valueOf(PageServer::start({}));
  PageScreen screen(*server, nullptr);
  EXPECT_TRUE(screen.begin(*run, host));
  const std::string log = home.path() / "log";
  int status = -1;
  std::thread client([&] {
    status = std::system(fmt::format("timeout 300 python3 '{}' 127.0.0.1:{} 1000 >'{}' 2>&1",
                                     test::sourceFile("docs/samples/watch_session.py").string(), server->port(), log)
                             .c_str());
  });
  EXPECT_TRUE(becomes([&] { return server->clients() == 1; }));
  Shown shown{&screen, {}, nullptr, {}};
  EXPECT_EQ(valueOf(play(*run, shown, host)), RunEnd::kOver);
  server.reset();
  client.join();
  (void)valueOf(run->stopRecording());

  std::map<std::string, std::string> truth;  // by the session's time
  RecordedRequest request;
  request.file = setting.record;
  const auto again = valueOf(lorica::Run::start(valueOf(prepareRecordedCast(request, host)), RunSetting(), host));
  while (!again->comparison->over() && valueOf(again->session.step())) {
    truth[fmt::format("{:.3f}", again->session.time())] = hashOf(again->session);
  }
  EXPECT_FALSE(again->comparison->difference());
  const std::string said = valueOf(readFile(log));
  EXPECT_EQ(status, 0) << said;
  std::istringstream lines(said);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "hello: walk");
  int frames = 0;
  for (; std::getline(lines, line); ++frames) {
    const auto found = truth.find(line.substr(0, line.find(' ')));
    ASSERT_NE(found, truth.end()) << line;
    EXPECT_TRUE(line.ends_with(" joints " + found->second)) << line;
  }
  EXPECT_GT(frames, 0);
}

struct EndingHost final : Host {
  [[nodiscard]] bool cancelled() const override { return ended; }
  std::atomic<bool> ended = false;
};

/// A client that acknowledges all frames until something comes. @return whether it came
/// @param steps  it asks for a step of the session with each frame: neither waits for a time
bool comes(TestClient& client, const std::function<bool(const TestClient::Message&)>& expected, bool steps = false) {
  for (;;) {
    const TestClient::Message message = client.next();
    if (message.kind == 0 || message.kind == 8) return false;
    if (message.kind == 2) {
      client.send({{"type", "ack"}, {"frame", message.number()}});
      if (steps) client.send({{"set", "step"}});
    }
    if (expected(message)) return true;
  }
}

/// Where a frame says that a prop is; none = it has not moved.
std::optional<Vec3> propIn(const TestClient::Message& frame, int prop) {
  const char* data = frame.bytes.data();
  for (std::size_t at = 32; frame.kind == 2 && at < frame.bytes.size();) {
    const auto length = loadLittleEndian<std::uint32_t>(data + at + 4);
    const std::size_t count = length / 24;
    for (std::size_t i = 0; loadLittleEndian<std::uint16_t>(data + at) == 3 && i < count; ++i) {
      const char* one = data + at + 12 + 24 * i;
      if (loadLittleEndian<std::uint16_t>(one) != prop) continue;
      const auto at3 = [&](int c) { return loadLittleEndian<float>(one + 4 + 4 * c); };
      return Vec3(at3(0), at3(1), at3(2));
    }
    at += 8 + (length + 3) / 4 * 4;
  }
  return std::nullopt;
}

/// A recorded session, which runs the same again.
SessionFile replayed(const std::filesystem::path& file) {
  Host host;
  RecordedRequest request;
  request.file = file.string();
  const auto run = valueOf(lorica::Run::start(valueOf(prepareRecordedCast(request, host)), RunSetting(), host));
  while (!run->comparison->over() && valueOf(run->session.step())) {
  }
  EXPECT_EQ(run->comparison->steps(), static_cast<int>(run->recorded().steps.size()));
  EXPECT_FALSE(run->comparison->difference());
  return run->recorded();
}

/// What clients drag and throw is in the recorded session, which runs the same without them. Two clients hold with both
/// hands; two of the four hands hold the same prop.
TEST(ServedRun, WhatClientsDragAndThrowReplaysTheSame) {
  const Home home;
  EndingHost host;
  RunSetting setting;
  setting.record = home.path() / "served.lsession";
  setting.atEnd = AtEnd::kHold;
  const auto run = valueOf(lorica::Run::start(walkingCast(host), setting, host));
  // Loose props, from above.
  const std::span<const Prop> props = run->session.world().props();
  std::vector<int> loose;
  std::vector<Vec3> before;
  for (int i = 0; i < static_cast<int>(props.size()) && loose.size() < 3; ++i) {
    const Vec3 at = props[i].worldFromProp.translation();
    const std::optional<PropPick> pick = run->session.world().pick({at + Vec3(0.0, 3.0, 0.0), -Vec3::UnitY()});
    if (props[i].mass == 0.0 || !pick || pick->prop != i) continue;
    loose.push_back(i);
    before.push_back(at);
  }
  ASSERT_EQ(loose.size(), 3u);
  const auto pointing = [&](const char* type, int hand, int of, double x) {
    return Json{{"type", type},
                {"hand", hand},
                {"origin", {before[of].x() + x, before[of].y() + 3.0, before[of].z()}},
                {"direction", {0, -1, 0}},
                {"forward", {0, -1, 0}}};
  };

  ServeLimits limits;
  limits.messagesASecond = 1'000'000;
  std::unique_ptr<PageServer> server = valueOf(PageServer::start({}, limits));
  PageScreen screen(*server, nullptr);
  screen.choices().paused = true;
  EXPECT_TRUE(screen.begin(*run, host));
  std::thread client([&] {
    Watcher watcher(server->port());
    watcher.send({{"set", "step"}});
    std::unique_ptr<Watcher> other;
    const auto steps = [&](const auto& expected) {
      return comes(
          watcher,
          [&](const auto& m) {
            if (other) other->send({{"type", "show"}, {"layers", Json::array()}});  // it is still there
            return expected(m);
          },
          true);
    };
    const auto holds = [&](bool on) {
      return steps([&](const auto& m) { return m.kind == 1 && m.json().value("holds", !on) == on; });
    };
    std::vector<Vec3> now = before;
    const auto moved = [&](int of) {
      return steps([&](const auto& m) {
        for (int i = 0; i < 3; ++i) now[i] = propIn(m, loose[i]).value_or(now[i]);
        return (now[of] - before[of]).norm() > 0.2;
      });
    };
    EXPECT_TRUE(steps([](const auto& m) { return m.kind == 2; })) << "no frame came";
    other = std::make_unique<Watcher>(server->port());
    watcher.send(pointing("press", 0, 0, 0.0));
    watcher.send(pointing("press", 1, 1, 0.0));
    other->send(pointing("press", 0, 2, 0.0));
    other->send(pointing("press", 1, 1, 0.0));
    EXPECT_TRUE(holds(true));
    watcher.send(pointing("drag", 0, 0, 0.5));
    EXPECT_TRUE(moved(0));
    other->send(pointing("drag", 0, 2, 0.5));
    EXPECT_TRUE(moved(2));
    for (Watcher* one : {&watcher, other.get()}) one->send(pointing("drag", 1, 1, 0.5));
    EXPECT_TRUE(moved(1));
    watcher.send({{"type", "release"}, {"hand", 0}, {"velocity", {0, 2, 0}}});
    watcher.send({{"type", "release"}, {"hand", 1}});
    for (int i = 0; i < 20; ++i) EXPECT_TRUE(steps([](const auto& m) { return m.kind == 2; }));
    other.reset();
    EXPECT_TRUE(holds(false)) << "the other client left";
    watcher.send({{"type", "throw"}, {"origin", {0, 1, 4}}, {"target", {2, 1, 0}}});
    EXPECT_TRUE(steps([&](const auto& m) {
      return m.kind == 1 && m.json()["type"] == "props" && m.json()["props"].size() > props.size();
    }));
    host.ended = true;
  });
  EXPECT_TRUE(becomes([&] { return server->clients() == 1; }));
  Shown shown{&screen, {}, nullptr, {}};
  EXPECT_EQ(valueOf(play(*run, shown, host)), RunEnd::kInterrupted);
  client.join();

  const SessionFile recorded = replayed(setting.record);
  using Kind = WorldAction::Kind;
  std::map<Kind, int> done;
  std::map<int, std::vector<Kind>> ofHand;  // grabs and releases
  for (const WorldAction& action : recorded.actions) {
    ++done[action.kind];
    if (action.kind == Kind::kThrowBall) {
      EXPECT_NEAR(action.velocity.x(), -0.5 * action.velocity.z(), 1e-9) << "at the avatar, not at the target";
    }
    if (action.kind == Kind::kGrab || action.kind == Kind::kRelease) ofHand[action.hand].push_back(action.kind);
  }
  EXPECT_EQ(ofHand.size(), 4u) << "each hand of each client is one of the world's";
  for (const auto& [hand, kinds] : ofHand) EXPECT_EQ(kinds, (std::vector{Kind::kGrab, Kind::kRelease})) << hand;
  EXPECT_GT(done[Kind::kMoveGrab], 0);
  EXPECT_EQ(done[Kind::kThrowBall], 1);
}

TEST(VrmLicence, SaysWhatAFileSaysAgainstBeingGivenToOthers) {
  using Document = nlohmann::ordered_json;
  EXPECT_EQ(vrmLicence(Document::object()), "");
  const auto said = [](const char* extension, const Document& meta) {
    return vrmLicence(Document{{"extensions", {{extension, {{"meta", meta}}}}}}) != "";
  };
  EXPECT_FALSE(said("VRMC_vrm", {{"name", "one"}, {"allowRedistribution", true}}));
  EXPECT_TRUE(said("VRMC_vrm", {{"name", "one"}, {"allowRedistribution", false}}));
  EXPECT_TRUE(said("VRMC_vrm", {{"name", "one"}}));
  EXPECT_FALSE(said("VRM", {{"licenseName", "CC_BY"}}));
  EXPECT_TRUE(said("VRM", {{"licenseName", "Redistribution_Prohibited"}}));
}

/// Before anybody can get it.
TEST(ServedRun, ALicenceIsSaidBeforeTheCharacterIsServed) {
  const test::TemporaryFolder folder;
  const auto server = valueOf(PageServer::start({}));
  const auto statusOf = [&] { return TestClient(server->port()).get("/character/0.glb").substr(9, 3); };
  struct Warned final : Host {
    std::function<void()> heard;
    void warn(const std::string& sentence) override {
      if (sentence.find("licence") != std::string::npos) heard();
    }
  } host;
  std::vector<std::string> statuses;
  host.heard = [&] { statuses.push_back(statusOf()); };
  test::GlbWriter writer = test::mannequinWriter(false);
  writer.document["extensions"]["VRM"] = {{"meta", {{"licenseName", "Redistribution_Prohibited"}}}};
  CastRequest request;
  request.character = folder.write("owned.vrm", writer.glb());
  request.motion = "walk";
  request.reading.drawn = true;
  const auto run = valueOf(lorica::Run::start(valueOf(prepareCast(request, host)), {}, host));
  PageScreen screen(*server, nullptr);
  EXPECT_TRUE(screen.begin(*run, host));
  EXPECT_EQ(statuses, std::vector<std::string>{"404"});
  EXPECT_TRUE(becomes([&] { return statusOf() == "200"; }));
}

/// Plays a walk while a client does something, and in turn what is opened meanwhile.
/// @param recordings  the folder that the command names; empty = none
/// @param whyNot  nothing else can be opened; empty = it can
void serveWalk(const std::string& recordings, const std::function<void(TestClient&)>& act,
               const std::string& whyNot = "") {
  EndingHost host;
  ServeSetting served;
  served.recordings = recordings;
  std::unique_ptr<PageServer> server = valueOf(PageServer::start(served));
  PageScreen screen(*server, nullptr);
  Cast cast = walkingCast(host);
  WindowOpener opener(cast, host, whyNot);
  opener.recordInto(recordings);
  std::thread client([&] {
    Watcher watcher(server->port());
    act(watcher);
    host.ended = true;
  });
  RunSetting setting;
  Shown shown{&screen, {}, &opener, std::move(cast)};
  for (RunEnd end = RunEnd::kExchanged; end == RunEnd::kExchanged;) {
    setting.record = std::exchange(shown.record, "");
    const auto run = valueOf(lorica::Run::start(std::move(*shown.next), setting, host));
    shown.next.reset();
    EXPECT_TRUE(screen.begin(*run, host));
    end = valueOf(play(*run, shown, host));
  }
  client.join();
}

/// The first message of a type that is as expected.
Json messageOf(TestClient& client, const char* type, const std::function<bool(const Json&)>& expected) {
  Json last;
  EXPECT_TRUE(comes(client, [&](const auto& m) {
    if (m.kind != 1) return false;
    last = m.json();
    return last["type"] == type && expected(last);
  })) << type;
  return last;
}

/// A control of the newest list that is as expected.
Json controlOf(TestClient& client, const std::string& id, const std::function<bool(const Json&)>& expected) {
  Json control;
  (void)messageOf(client, "controls", [&](const Json& message) {
    for (const Json& one : message["controls"]) {
      if (one["id"] == id) control = one;
    }
    return expected(control);
  });
  return control;
}

/// Its choices, once there are so many.
std::vector<std::string> choicesOf(TestClient& client, const std::string& id, std::size_t count) {
  return controlOf(client, id, [&](const Json& control) { return control["choices"].size() == count; })["choices"];
}

/// A recording is begun and ended from the page, into the folder of the command and under a name of the server.
TEST(ServedRun, ClientsRecordIntoTheFolderOfTheCommand) {
  const Home home;
  std::string name;
  serveWalk(home.path(), [&](TestClient& client) {
    client.send({{"set", "record"}, {"to", true}});
    const Json first = messageOf(client, "state", [](const Json& state) { return state["recording"] != ""; });
    name = first["recording"];
    (void)messageOf(client, "state", [&](const Json& state) { return state["seconds"] > first["seconds"]; });
    client.send({{"set", "record"}, {"to", false}});
    (void)messageOf(client, "state", [](const Json& state) { return state["recording"] == ""; });
  });
  EXPECT_TRUE(name.ends_with("_001.lsession")) << name;
  EXPECT_TRUE(replayed(home.path() / name).finished);
}

/// Sends a file as the page does. @return the status of the answer
std::string sends(const TestClient& watcher, const std::string& ending, const std::string& bytes) {
  TestClient client(std::stoi(watcher.host.substr(watcher.host.find(':') + 1)));
  client.write("PUT /open/" + ending + " HTTP/1.1\r\nHost: " + client.host +
               "\r\nConnection: close\r\nContent-Length: " + std::to_string(bytes.size()) + "\r\n\r\n" + bytes);
  const std::string answer = client.read();
  return answer.size() > 12 ? answer.substr(9, 3) : answer;
}

std::string bvhOfAPerson() {
  return valueOf(readFile(test::sourceFile("tests/fuzz/corpus/bvh/person.bvh")));
}

/// What a client sends is opened as what is dropped on a window: a motion is performed by the present character, a
/// character performs the present motion.
TEST(ServedRun, ClientsOpenTheirOwnFiles) {
  const Home home;
  WindowSettings owner;
  owner.recent = {home.write("own.bvh", bvhOfAPerson())};
  ASSERT_TRUE(writeWindowSettings(windowSettingsFile(), owner));
  serveWalk(home.path(), [&](TestClient& client) {
    const Json first = messageOf(client, "hello", [](const Json&) { return true; });
    EXPECT_EQ(first["name"], "walk");
    const Json list = messageOf(client, "controls", [](const Json&) { return true; })["controls"];
    for (const Json& control : list) {
      EXPECT_TRUE(control["id"] != "open" || !control.contains("no")) << control;
      EXPECT_TRUE(control["id"] != "sent" || control["choices"].empty()) << "those of the window are its owner's";
    }
    client.send({{"set", "smoothing"}, {"to", 1}});
    (void)controlOf(client, "smoothing", [](const Json& control) { return control["value"] == 1.0; });
    EXPECT_EQ(sends(client, "bvh", bvhOfAPerson()), "202");
    const Json moved = messageOf(client, "hello", [](const Json& hello) { return hello["run"] == 2; });
    EXPECT_TRUE(moved["name"].get<std::string>().ends_with("_001")) << moved["name"];
    EXPECT_EQ(moved["avatars"][0]["name"], first["avatars"][0]["name"]);
    EXPECT_EQ(sends(client, "glb", test::mannequinGlb(false)), "202");
    const Json other = messageOf(client, "hello", [](const Json& hello) { return hello["run"] == 3; });
    EXPECT_EQ(other["name"], moved["name"]) << "it performs the present motion";
    EXPECT_NE(other["avatars"][0]["name"], first["avatars"][0]["name"]);
    const std::string own = choicesOf(client, "avatar", 2)[0];
    EXPECT_TRUE(own.ends_with("_001.glb")) << own;
    // It stays in the list, and can be chosen again.
    client.send({{"set", "avatar"}, {"to", 1}});
    (void)messageOf(client, "hello", [](const Json& hello) { return hello["run"] == 4; });
    const std::vector<std::string> back = choicesOf(client, "avatar", 2);
    client.send({{"set", "avatar"}, {"to", back[0] == own ? 0 : 1}});
    (void)messageOf(client, "hello", [](const Json& hello) { return hello["run"] == 5; });
  });
  // Another time they are opened by their names.
  serveWalk(home.path(), [&](TestClient& client) {
    const Json list = messageOf(client, "controls", [](const Json&) { return true; })["controls"];
    std::map<std::string, std::vector<std::string>> choices;
    for (const Json& control : list) choices[control["id"]] = control.value("choices", std::vector<std::string>());
    ASSERT_EQ(choices["sent"].size(), 1u) << list;
    const std::string again = choices["sent"][0];
    EXPECT_TRUE(again.ends_with("_001.bvh")) << again;
    EXPECT_EQ(choices["avatar"].size(), 2u) << list;
    client.send({{"set", "sent"}, {"to", 1}});
    client.send({{"set", "sent"}, {"to", 0}});
    const Json moved = messageOf(client, "hello", [](const Json& hello) { return hello["run"] == 2; });
    EXPECT_EQ(moved["name"].get<std::string>() + ".bvh", again);
  });
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(home.path() / "opened"), {}), 2) << "they are kept";
  const WindowSettings kept = test::valueOf(readWindowSettings(windowSettingsFile()));
  EXPECT_TRUE(kept == owner) << "what others open and choose is not kept for the window";
}

/// The sentence of the reader comes to the page without the folder, the run goes on, and nothing is left of the file.
TEST(ServedRun, BadFilesOfClientsAreASentenceAndAreRemoved) {
  const Home home;
  serveWalk(home.path(), [&](TestClient& client) {
    const std::string bvh = bvhOfAPerson();
    const std::vector<std::pair<const char*, std::string>> rows = {{"bvh", bvh.substr(0, bvh.size() / 3)},
                                                                   {"glb", "glTF and no more"},
                                                                   {"fbx", "Kaydara FBX Binary"},
                                                                   {"stl", "solid"},
                                                                   {"csv", "\x89PNG\r\n"},
                                                                   {"json", "{"},
                                                                   {"txt", std::string(1000, '\0')}};
    for (const auto& [ending, bytes] : rows) {
      EXPECT_EQ(sends(client, ending, bytes), "202");
      const Json said = messageOf(client, "notice", [](const Json& notice) { return notice["problem"]; });
      const std::string text = said["text"];
      EXPECT_NE(text.find(std::string("_001.") + ending), std::string::npos) << text;
      EXPECT_NE(text.find("; still playing walk"), std::string::npos) << text;
      EXPECT_EQ(text.find(home.path().filename()), std::string::npos) << "folders are nobody's business: " << text;
      EXPECT_TRUE(becomes([&] { return std::filesystem::is_empty(home.path() / "opened"); })) << ending;
    }
    const Json state = messageOf(client, "state", [](const Json&) { return true; });
    EXPECT_EQ(state["title"].get<std::string>().find("2026"), std::string::npos);
  });
}

TEST(ServedRun, WhatIsWrittenOnceOpensNothing) {
  const Home home;
  serveWalk(
      home.path(),
      [&](TestClient& client) {
        const Json control = controlOf(client, "open", [](const Json& one) { return one.is_object(); });
        EXPECT_EQ(control["no"], kWrittenOnce);
        EXPECT_EQ(sends(client, "bvh", bvhOfAPerson()), "202");
        const Json said = messageOf(client, "notice", [](const Json& notice) { return notice["problem"]; });
        EXPECT_EQ(said["text"], kWrittenOnce);
        EXPECT_TRUE(becomes([&] { return std::filesystem::is_empty(home.path() / "opened"); }));
      },
      kWrittenOnce);
}

TEST(ServedRun, WithoutAFolderNothingIsRecorded) {
  const Home home;
  serveWalk("", [&](TestClient& client) {
    const Json list = messageOf(client, "controls", [](const Json&) { return true; })["controls"];
    std::map<std::string, std::string> no;
    for (const Json& control : list) no[control["id"]] = control.value("no", "");
    EXPECT_NE(no["record"], "");
    EXPECT_NE(no["open"].find("--recordings"), std::string::npos);
    client.send({{"set", "record"}, {"to", true}});
    (void)messageOf(client, "notice", [&](const Json& notice) { return notice["text"] == no["record"]; });
  });
}

}  // namespace
}  // namespace lorica
