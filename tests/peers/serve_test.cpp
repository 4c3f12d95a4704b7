// The page of `lorica serve` in a browser, as people use it.
#include "capture/registration/head_registration.h"
#include "geometry/counts.h"
#include "geometry/files.h"
#include "session/prepare/cast.h"
#include "session/prepare/live_cast.h"
#include "session/prepare/scenes.h"
#include "session/recording/session_file.h"
#include "tests/apps/mannequin_glb.h"
#include "tests/peers/likeness.h"
#include "tests/peers/peer.h"
#include "tests/support/background_process.h"
#include "tests/support/datasets.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"
#include "viewer/page/page_files.h"
#include "viewer/page/page_screen.h"
#include "viewer/pictures/image_files.h"
#include "viewer/player/headset_link.h"
#include "viewer/player/run.h"
#include "viewer/player/snapshots.h"

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

#define LORICA_REQUIRE_PAGE() \
  if (!pageBuilt()) GTEST_SKIP() << "this Lorica was built without its page: run scripts/setup --page and build again"

/// The built program while it serves a recording. Sessions are recorded into `recordings`.
class Served {
 public:
  [[nodiscard]] fs::path recordings() const { return folder_.path() / "recordings"; }
  /// Where to watch; empty if nothing is served after two minutes.
  [[nodiscard]] std::string link() const {
    const std::string before = "Watch at ";
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    while (std::chrono::steady_clock::now() < end) {
      std::ifstream stream(log_);
      const std::string text{std::istreambuf_iterator<char>(stream), {}};
      const std::size_t at = text.find(before);
      const std::size_t stop = at == std::string::npos ? at : text.find('\n', at);
      if (stop != std::string::npos) return text.substr(at + before.size(), stop - at - before.size());
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return "";
  }

 private:
  // Of several that are served at a time, each finds a port of its own.
  void become() const {
    setenv("LORICA_RECORDINGS", test::recordingsFolder().c_str(), 1);
    setenv("XDG_CONFIG_HOME", "/dev/null", 1);  // the settings of whoever runs the tests stay as they are
    unsetenv("DISPLAY");
    const std::string program = test::built("lorica");
    execl(program.c_str(), program.c_str(), "serve", "punch_and_kick", "--recordings", recordings().c_str(), nullptr);
  }

  test::TemporaryFolder folder_;
  fs::path log_ = folder_.write("log", "");
  test::BackgroundProcess process_{[this] { become(); }, log_};
};

const fs::path kPictures = test::built("peers") / "pictures" / "page";

/// Whether one of the changes that came asks for the start of the recording.
bool restarts(Screen& screen) {
  const std::vector<Change> changes = screen.takeChanges();
  return std::ranges::find(changes, ControlId::kRestart, &Change::id) != changes.end();
}

/// The controls of a screen that shows a recording of a second.
Controls controlsOf(Screen& screen) {
  Controls controls;
  listChoices(screen.choices(), controls);
  controls.offer(ControlId::kRestart);
  controls.offer(ControlId::kSeek).most = 1.0;
  controls.offer(ControlId::kThrow);
  controls.offer(ControlId::kParts).absent = true;
  return controls;
}

/// What page_check.mjs finds out. Fails the test, and returns nothing, if it finds a fault.
json check(const std::string& link, const char* part) {
  if (link.empty()) {
    ADD_FAILURE() << "nothing is served";
    return {};
  }
  setenv("PARTS", part, 1);
  if (!test::runPeer("page_check.mjs", {link, kPictures.string()})) return {};
  json result = test::readJson(kPictures / "result.json");
  EXPECT_TRUE(result.at("errors").empty()) << result["errors"];
  EXPECT_TRUE(result.at("outside").empty()) << "it asks others: " << result["outside"];
  return result;
}

TEST(PeerServe, ThePageDrawsPlaysDragsAndThrows) {
  LORICA_REQUIRE_PEERS();
  LORICA_REQUIRE_PAGE();
  const Served served;
  const json result = check(served.link(), "desktop");
  if (result.empty()) return;
  const json& desktop = result.at("desktop");
  ASSERT_EQ(desktop.at("avatars").size(), 1u);
  const json& avatar = desktop["avatars"][0];
  EXPECT_TRUE(avatar.at("loaded").get<bool>()) << avatar;
  EXPECT_TRUE(avatar.at("present").get<bool>()) << avatar;
  const double height = avatar.at("center").at(1);
  EXPECT_GT(height, 0.4) << "it stands on the floor";
  EXPECT_LT(height, 1.6);
  EXPECT_GT(desktop.at("props").get<int>(), 0);
  EXPECT_GT(desktop.at("frames").get<int>(), 0);
  EXPECT_TRUE(desktop.at("problems").empty()) << desktop["problems"];
  EXPECT_TRUE(result.at("helpFits").get<bool>()) << "1280 x 720, without scrolling";
  EXPECT_FALSE(result.at("helpStays").get<bool>()) << "H closes what it opened";

  const json& video = result.at("video");
  EXPECT_EQ(video.at("size"), video.at("canvas"));
  EXPECT_GT(video.at("seconds").get<double>(), 0.0);
  EXPECT_GT(video.at("colors").get<int>(), 100);

  const json& play = result.at("play");
  EXPECT_LT(play.at("restartedAt").get<double>(), std::max(play.at("pausedAt").get<double>(), 0.2));

  const json& drag = result.at("drag");
  ASSERT_FALSE(drag.contains("none")) << "there is no prop to drag";
  EXPECT_GT(drag.at("moved").get<double>(), 0.1);
  EXPECT_LT(drag.at("cameraMoved").get<double>(), 1e-3) << "a drag of a prop must not orbit";
  EXPECT_TRUE(drag.at("orbits").get<bool>());

  const json& thrown = result.at("throw");
  ASSERT_FALSE(thrown.contains("cannot")) << thrown;
  EXPECT_GT(thrown.at("props").at(1).get<int>(), thrown.at("props").at(0).get<int>());

  // It was recorded meanwhile.
  const fs::path file = served.recordings() / result.at("recorded").get<std::string>();
  const SessionFile recorded = test::valueOf(readSession(file));
  std::map<WorldAction::Kind, int> done;
  for (const WorldAction& action : recorded.actions) ++done[action.kind];
  EXPECT_EQ(done[WorldAction::Kind::kGrab], 1);
  EXPECT_GT(done[WorldAction::Kind::kMoveGrab], 0);
  EXPECT_EQ(done[WorldAction::Kind::kThrowBall], 1);
  const fs::path report = served.recordings() / "replay.json";
  const std::string replay = fmt::format("'{}' replay '{}' --json '{}' >/dev/null 2>&1", test::built("lorica").string(),
                                         file.string(), report.string());
  EXPECT_EQ(std::system(replay.c_str()), 0) << replay;
  EXPECT_TRUE(test::readJson(report).at("same").get<bool>());
}

/// A link with another token or without https, a browser without WebGL or without WebXR, a session that ends while
/// somebody watches; over TLS.
TEST(PeerServe, ThePageSaysWhatIsWrong) {
  LORICA_REQUIRE_PEERS();
  LORICA_REQUIRE_PAGE();
  const test::TemporaryFolder home;
  setenv("XDG_CONFIG_HOME", home.path().c_str(), 1);
  setenv("LORICA_RECORDINGS", test::recordingsFolder().c_str(), 1);
  Host host;
  ServeSetting setting;
  setting.lan = true;
  ServeLimits limits;
  limits.goodbyeSeconds = 600.0;  // a busy machine's browser reads the last message late
  auto server = test::valueOf(PageServer::start(setting, limits));
  PageScreen screen(*server, nullptr);
  CastRequest request;
  request.motion = "walk";
  request.reading.drawn = true;
  const auto run = test::valueOf(lorica::Run::start(test::valueOf(prepareCast(request, host)), {}, host));
  EXPECT_TRUE(test::valueOf(run->session.step()));
  EXPECT_TRUE(screen.begin(*run, host));

  json result;
  std::atomic<bool> ended = false;
  std::thread browser([&, link = fmt::format("https://localhost:{}/#{}", server->port(), server->facts().token)] {
    result = check(link, "wrong");
    ended = true;
  });
  SessionScene scene(run->session);
  WindowValues values;
  const Controls controls = controlsOf(screen);
  values.controls = &controls;
  values.duration = 1.0;
  while (!ended && !restarts(screen)) {
    ++values.changes;
    screen.show(scene.of(run->session, {}, screen.camera().eye), values);
    screen.rest(0.02);
  }
  server.reset();
  browser.join();
  if (result.empty()) return;
  const json& wrong = result.at("wrong");
  EXPECT_EQ(wrong.at("token"), "This link is not or no longer valid. Please use the one that the program shows now.");
  EXPECT_EQ(wrong.at("webgl"), "This page needs WebGL 2, which this browser does not have or has switched off.");
  EXPECT_NE(wrong.at("webxr").get<std::string>().find("This browser has no VR or AR. The one in a headset has."),
            std::string::npos);
  EXPECT_NE(wrong.at("http").get<std::string>().find("VR and AR need a link with https."), std::string::npos);
  EXPECT_FALSE(wrong.at("secure").get<bool>());
  EXPECT_TRUE(wrong.at("without").get<bool>()) << "http://localhost:PORT/#TOKEN is no way to the page";
  EXPECT_EQ(wrong.at("over"), "The session is over. This page continues when another one starts.");
}

/// By its button, its key and by dropping: what the page sends is opened as what is dropped on a window, and what
/// cannot be opened is a sentence of the reader.
TEST(PeerServe, ThePageOpensFilesOfItsOwn) {
  LORICA_REQUIRE_PEERS();
  LORICA_REQUIRE_PAGE();
  const Served served;
  const test::TemporaryFolder own;
  const std::string bvh = test::valueOf(readFile(test::sourceFile("tests/fuzz/corpus/bvh/person.bvh")));
  const std::vector<std::string> files = {own.write("dance.bvh", bvh), own.write("notes.pdf", "%PDF-1.7"),
                                          own.write("Own Hero.GLB", test::facesGlb(false)),
                                          own.write("broken.bvh", bvh.substr(0, bvh.size() / 3))};
  setenv("FILES", fmt::format("{}", fmt::join(files, ",")).c_str(), 1);
  const json result = check(served.link(), "files");
  if (result.empty()) return;
  const json& opened = result.at("files");
  ASSERT_EQ(opened.size(), files.size());
  for (const std::size_t good : {0, 2}) {
    EXPECT_TRUE(opened[good].at("exchanged").get<bool>()) << opened[good];
    EXPECT_EQ(opened[good].at("said"), "") << opened[good];
    ASSERT_EQ(opened[good].at("avatars").size(), 1u);
    EXPECT_TRUE(opened[good]["avatars"][0].at("loaded").get<bool>()) << opened[good];
  }
  EXPECT_TRUE(opened[0].at("title").get<std::string>().find("_001") != std::string::npos) << opened[0];
  EXPECT_EQ(opened[0]["avatars"][0].at("name"), "mannequin");
  EXPECT_NE(opened[2]["avatars"][0].at("name"), "mannequin") << "the avatar is another one";
  EXPECT_EQ(opened[2].at("characters").size(), 2u) << "it is in the list, beside the mannequin";
  for (const auto& [bad, words] :
       {std::pair(3, "_002.bvh"), std::pair(1, "notes.pdf: files that the page opens end in")}) {
    EXPECT_FALSE(opened[bad].at("exchanged").get<bool>()) << opened[bad];
    EXPECT_NE(opened[bad].at("said").get<std::string>().find(words), std::string::npos) << opened[bad];
    EXPECT_EQ(opened[bad]["avatars"].at(0).at("name"), opened[bad - 1]["avatars"].at(0).at("name"))
        << "the run goes on";
  }
  const json& recents = result.at("recents");
  ASSERT_EQ(recents.size(), 1u) << recents;
  EXPECT_TRUE(recents[0].get<std::string>().ends_with("_001.bvh")) << recents;
  std::vector<std::string> kept;
  for (const auto& entry : fs::directory_iterator(served.recordings() / "opened")) {
    kept.push_back(test::valueOf(readFile(entry.path())));
  }
  EXPECT_EQ(kept.size(), 2u) << "what cannot be opened is not kept";
  EXPECT_NE(std::find(kept.begin(), kept.end(), bvh), kept.end());
}

TEST(PeerServe, ThePageFitsAPhone) {
  LORICA_REQUIRE_PEERS();
  LORICA_REQUIRE_PAGE();
  const Served served;
  const json result = check(served.link(), "phone");
  if (result.empty()) return;
  EXPECT_TRUE(result.at("phone").get<bool>());
}

/// A link for OBS: an alpha channel, nothing but the avatar, no panels.
TEST(PeerServe, ALinkShowsTheAvatarAloneOnNothing) {
  LORICA_REQUIRE_PEERS();
  LORICA_REQUIRE_PAGE();
  const Served served;
  const json result = check(served.link(), "source");
  if (result.empty()) return;
  const json& source = result.at("source");
  EXPECT_TRUE(source.at("problems").empty()) << source;
  EXPECT_EQ(source.at("size"), json({1280, 720}));
  EXPECT_GT(source.at("opaque").get<double>(), 0.02) << "the avatar";
  EXPECT_GT(source.at("clear").get<double>(), 0.75) << "and nothing around it";
  EXPECT_GT(source.at("left").get<int>(), 200) << "no panels and messages";
  EXPECT_LT(source.at("right").get<int>(), 1080);
  EXPECT_EQ(source.at("framed").at("free"), json({0, 0, 1280, 720}));
  const json& wrong = source.at("wrong");
  EXPECT_NE(wrong.dump().find("nowhere: no scene with this name"), std::string::npos) << wrong;
  EXPECT_NE(wrong.dump().find("pink: no background with this name"), std::string::npos) << wrong;
}

TEST(PeerServe, AHeadsetStandsBesideGrabsAndLooksOutOfTheAvatar) {
  LORICA_REQUIRE_PEERS();
  LORICA_REQUIRE_PAGE();
  const Served served;
  const json result = check(served.link(), "vr");
  if (result.empty()) return;
  const json& vr = result.at("vr");
  EXPECT_NEAR(vr.at("eyeHeight").get<double>(), 1.6, 0.01) << "the headset's own height over the floor";
  EXPECT_GT(vr.at("distance").get<double>(), 0.5) << "beside, not inside";
  ASSERT_TRUE(vr.contains("grab")) << "there are no two props to grab";
  EXPECT_NE(vr["grab"].at("holds").at("left"), vr["grab"].at("holds").at("right"));
  for (const char* side : {"left", "right"}) EXPECT_GT(vr["grab"].at(side).get<double>(), 0.2) << side;
  const json &right = vr.at("released").at(0), &left = vr.at("released").at(1);
  EXPECT_NE(right.at("hand"), left.at("hand"));
  EXPECT_GE(right.at("velocity").at(1).get<double>(), vr.at("quick").get<bool>() ? 1e-3 : 0.0) << "it is thrown up";
  EXPECT_LT(vr.at("inside").at("distance").get<double>(), 0.6) << "inside";
  EXPECT_TRUE(vr.at("ar").get<bool>());
}

/// The tracked head is where the headset says that it is, from another origin, 60 ms late, with noise and dropouts. The
/// page walks with each picture, and a pose is a thirtieth of a second, so that nothing depends on how quick the
/// machine is.
TEST(PeerServe, AWalkWithAHeadsetRegistersItThroughThePage) {
  LORICA_REQUIRE_PEERS();
  LORICA_REQUIRE_PAGE();
  const test::TemporaryFolder home;
  setenv("XDG_CONFIG_HOME", home.path().c_str(), 1);
  setenv("LORICA_RECORDINGS", test::recordingsFolder().c_str(), 1);
  constexpr double kLag = 0.06, kYaw = 1.1;
  const Isometry3 floorFromStage =
      Eigen::Translation3d(0.7, 0.01, -2.3) * Isometry3(Eigen::AngleAxisd(kYaw, Vec3::UnitY()));

  Host host;
  const auto server = test::valueOf(PageServer::start({}));
  PageScreen screen(*server, nullptr);
  CastRequest request;
  request.reading.drawn = true;
  LiveRequest live;
  live.depth.virtualCamera = true;
  const auto run = test::valueOf(lorica::Run::start(test::valueOf(prepareLiveCast(request, live, host)), {}, host));
  EXPECT_TRUE(screen.begin(*run, host));
  while (run->session.frameCount() < 5 && test::valueOf(run->session.step())) {
  }

  json result;
  std::atomic<bool> ended = false;
  std::thread browser([&] {
    result = check(server->facts().links.front(), "walk");
    ended = true;
  });
  HeadsetLink link;
  link.begin("a camera that walks", std::make_shared<WornHeadset>());
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.015);
  SessionScene scene(run->session);
  WindowValues values;
  const Controls controls = controlsOf(screen);
  values.controls = &controls;
  std::vector<ClientMessage> messages;
  int poses = 0;
  while (!ended) {
    messages.clear();
    server->takeMessages(messages);
    for (const ClientMessage& message : messages) {
      if (message.kind != ClientMessage::Kind::kHead) continue;
      const double time = ++poses / 30.0;
      HeadsetPose pose;
      pose.pose = message.pose;
      pose.pose.time = time;
      link.addHeadset(pose, time);
      const Vec3 head = message.pose.head * kNominalHeadInHeadset;
      const Vec3 off(noise(random), noise(random), noise(random));
      if (random() % 8 != 0) link.addTracked(0, floorFromStage * head + off, time + kLag);
      std::optional<WearerState> state = link.update(time);
      while (link.solving()) state = link.update(time);
      if (state) screen.setWearer(*state);
    }
    ++values.changes;
    SceneOptions sent;
    screen.show(scene.of(run->session, sent, screen.camera().eye), values);
    screen.rest(0.01);
  }
  browser.join();
  if (result.empty()) return;
  const json& walk = result.at("walk");
  const json& told = walk.at("registration");
  fmt::print("registered after {:.1f} m: {}\n", walk.at("walked").get<double>(), told.dump());
  fmt::print("and after 8 m: {}\n", walk.at("last").dump());
  EXPECT_FALSE(walk.at("standing").at("known").get<bool>()) << "who stands is told to walk";
  EXPECT_NEAR(told.at("yaw").get<double>(), kYaw, 0.0174533);
  EXPECT_LT(told.at("degrees").get<double>(), 1.0);
  const auto levelError = [&](const json& said) {
    const json& at = said.at("translation");
    const Vec3 off = Vec3(at.at(0), at.at(1), at.at(2)) - floorFromStage.translation();
    return std::hypot(off.x(), off.z());
  };
  EXPECT_LT(levelError(told), 0.04);
  // 10 mm at 95 % of walks of 10 s and 8 m, of which this is one: tests/capture/registration has a hundred.
  EXPECT_LT(levelError(walk["last"]), 0.015);
  EXPECT_NEAR(walk["last"].at("yaw").get<double>(), kYaw, 0.5 * 0.0174533);
  EXPECT_EQ(walk.at("rig").at("yaw"), walk.at("now").at("yaw")) << "the page turns its room by it";
}

constexpr int kSeen = 50;  // of 255: hulls are translucent

/// How alike a layer is in two pictures of a scene: where it is in each, by pictures of it alone.
/// @param sheet  gets the pictures side by side with their difference
test::Likeness layerLikeness(const Image& whole, const Image& alone, const Image& pageWhole, const Image& pageAlone) {
  const auto maskOf = [](Image picture) {
    for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
      std::fill_n(&picture.rgba[i], 3, picture.rgba[i + 3] >= kSeen ? 255 : 0);
    }
    return picture;
  };
  return test::likenessOf({whole, maskOf(alone)}, {pageWhole, maskOf(pageAlone)});
}

bool isEmpty(const Image& alone) {
  for (std::size_t i = 3; i < alone.rgba.size(); i += 4) {
    if (alone.rgba[i] != 0) return false;
  }
  return true;
}

/// A ball that becomes flat and wide, in a folder: a mesh in ten poses.
std::string flattenedBall(const test::TemporaryFolder& folder) {
  const TriMesh ball = test::makeSphere(0.6, 24, 48);
  for (int f = 0; f < 10; ++f) {
    std::string text;
    for (const Vec3& p : ball.vertices) {
      text += fmt::format("v {} {} {}\n", (1.0 + 0.08 * f) * p.x(), 1.0 + (1.0 - 0.07 * f) * p.y(), p.z());
    }
    for (const Triangle& t : ball.triangles) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    folder.write(fmt::format("ball_{}.obj", f), text);
  }
  return folder.path().string();
}

/// The page's pictures of all scenes, and of a mesh in several poses, beside those of `lorica snapshot`, of one frame
/// from one camera.
TEST(PeerServe, EachSceneLooksAsInASnapshot) {
  LORICA_REQUIRE_PEERS();
  LORICA_REQUIRE_PAGE();
  Result<SnapshotCamera> opened = SnapshotCamera::create(640, 360);
  if (!opened) GTEST_SKIP() << "cannot draw off screen: " << opened.error().message;
  SnapshotCamera pictures = std::move(*opened);
  const test::TemporaryFolder home;  // no choices that somebody has kept
  setenv("XDG_CONFIG_HOME", home.path().c_str(), 1);
  setenv("LORICA_RECORDINGS", test::recordingsFolder().c_str(), 1);
  Host host;
  const auto server = test::valueOf(PageServer::start({}));
  PageScreen screen(*server, nullptr);
  SceneList scenes = scenesNextTo("");
  const std::size_t ofScenes = scenes.names.size();
  scenes.names.emplace_back("a mesh in several poses");
  scenes.arguments.emplace_back("boxes");
  const test::TemporaryFolder poses;

  json result;
  std::atomic<bool> ended = false;
  std::thread browser([&] {
    result = check(server->facts().links.front(), "scenes");
    ended = true;
  });
  using Layer = std::pair<const char*, bool SceneOptions::*>;
  const std::array<Layer, 5> layers = {{{"character", &SceneOptions::skin},
                                        {"props", &SceneOptions::props},
                                        {"particles", &SceneOptions::particles},
                                        {"hulls", &SceneOptions::hulls},
                                        {"contacts", &SceneOptions::contacts}}};
  std::vector<std::map<std::string, Image>> drawn;
  WindowValues values;
  Controls controls = controlsOf(screen);
  controls.offer(ControlId::kScene).choices = scenes.names;
  values.controls = &controls;
  values.duration = 1.0;
  std::unique_ptr<lorica::Run> run;
  for (int index = 0; index < countOf(scenes.names) && !ended; ++index) {
    controls[ControlId::kScene].value = index;
    CastRequest request;
    if (static_cast<std::size_t>(index) < ofScenes) {
      request.motion = "punch_and_kick";
    } else {
      request.character = flattenedBall(poses);
    }
    request.scene = scenes.arguments[index];
    request.reading.drawn = true;
    auto next = test::valueOf(lorica::Run::start(test::valueOf(prepareCast(request, host)), {}, host));
    SessionScene scene(next->session);
    while (next->session.frameCount() < 60 && test::valueOf(next->session.step())) scene.follow(next->session);
    FollowCamera follow({}, 16.0 / 9.0);
    screen.setCamera(follow.still(next->session));
    const Camera camera = screen.camera();
    EXPECT_TRUE(screen.begin(*next, host));
    run = std::move(next);

    SceneOptions show;
    show.hulls = show.contacts = false;
    auto& own = drawn.emplace_back();
    const auto draw = [&] { return pictures.draw(scene.of(run->session, show, camera.eye), show, camera); };
    own["whole"] = draw();
    show.transparent = true;
    show.ground = false;
    for (const auto& [name, layer] : layers) {
      for (const auto& [other, member] : layers) show.*member = member == layer;
      own[name] = draw();
    }
    SceneOptions sent;
    sent.hulls = sent.contacts = true;
    // A restart is asked for when the pictures of a scene are taken.
    do {
      ++values.changes;
      screen.show(scene.of(run->session, sent, camera.eye), values);
      screen.rest(0.02);
    } while (!ended && !restarts(screen));
  }
  browser.join();
  if (result.empty()) return;
  ASSERT_EQ(result.at("scenes").size(), scenes.names.size());
  for (std::size_t s = 0; s < drawn.size(); ++s) {
    std::map<std::string, Image> page;
    for (const auto& [name, own] : drawn[s]) {
      page[name] = test::valueOf(readPng(kPictures / fmt::format("scene_{}_{}.png", s, name)));
    }
    std::vector<Image> sheet = {drawn[s]["whole"], page["whole"]};
    std::vector<std::string> labels = {"snapshot", "page"};
    for (const auto& [name, layer] : layers) {
      const bool whole = layer != &SceneOptions::hulls && layer != &SceneOptions::contacts;
      const Image &own = drawn[s][name], &its = page[name];
      ASSERT_EQ(isEmpty(own), isEmpty(its)) << scenes.names[s] << ": " << name;
      if (isEmpty(own)) continue;
      const test::Likeness like =
          whole ? layerLikeness(drawn[s]["whole"], own, page["whole"], its) : layerLikeness(own, own, its, its);
      fmt::print("{} {}: silhouettes {:.2f} % alike, {:.2f} % wholly wrong, mean difference {:.1f} of 255\n",
                 scenes.names[s], name, 100.0 * like.silhouettes, 100.0 * like.wrong, like.meanDifference);
      // Hulls are seen through each other; of grains a slow page gets few, and contacts are marks of a few pixels.
      if (whole && layer != &SceneOptions::particles) {
        EXPECT_GT(like.silhouettes, 0.99) << scenes.names[s] << ": " << name;
      }
      if (layer == &SceneOptions::hulls) {
        EXPECT_GT(like.silhouettes, 0.94) << scenes.names[s];
      }
      sheet.insert(sheet.end(), {own, its, like.shown});
      labels.insert(labels.end(), {name, name, name});
    }
    EXPECT_TRUE(writePng(kPictures / fmt::format("scene_{}.png", s), contactSheet(sheet, labels, 2)));
  }
}

/// Morph targets of a plain glTF file, which three.js moves and not three-vrm: the page's pictures beside Lorica's own.
TEST(PeerServe, MorphTargetsOfAPlainFileMoveAsInASnapshot) {
  LORICA_REQUIRE_PEERS();
  LORICA_REQUIRE_PAGE();
  Result<SnapshotCamera> opened = SnapshotCamera::create(480, 540);
  if (!opened) GTEST_SKIP() << "cannot draw off screen: " << opened.error().message;
  SnapshotCamera pictures = std::move(*opened);
  const test::TemporaryFolder home;
  setenv("XDG_CONFIG_HOME", home.path().c_str(), 1);
  Host host;
  const auto server = test::valueOf(PageServer::start({}));
  PageScreen screen(*server, nullptr);
  CastRequest request;
  request.character = home.write("faces.glb", test::facesGlb(false));
  request.reading.drawn = true;
  request.performing.clip = "Nod";
  const auto run = test::valueOf(lorica::Run::start(test::valueOf(prepareCast(request, host)), {}, host));
  SessionScene scene(run->session);
  while (run->session.frameCount() < 5 && test::valueOf(run->session.step())) scene.follow(run->session);
  Camera camera = screen.camera();
  camera.eye = Vec3(3.0, 1.1, 0.2);  // from the side, where the belly is seen
  camera.target = Vec3(0.0, 1.0, 0.0);
  screen.setCamera(camera);
  EXPECT_TRUE(screen.begin(*run, host));
  const std::vector<std::string> expressions = {"Belly", "Frown"};

  json result;
  std::atomic<bool> ended = false;
  std::thread browser([&] {
    result = check(server->facts().links.front(), "expressions");
    ended = true;
  });
  WindowValues values;
  Controls controls = controlsOf(screen);
  Control& expression = controls.offer(ControlId::kExpression);
  expression.choices = expressions;
  expression.least = expression.value = -1.0;
  values.controls = &controls;
  SceneOptions sent;
  while (!ended) {
    for (const Change& change : screen.takeChanges()) {
      if (change.id != ControlId::kExpression) continue;
      expression.value = valueAfter(expression, change).value_or(-1.0);
      scene.chooseExpression(static_cast<int>(expression.value));
    }
    ++values.changes;
    screen.show(scene.of(run->session, sent, screen.camera().eye), values);
    screen.rest(0.02);
  }
  browser.join();
  if (result.empty()) return;
  ASSERT_EQ(result.at("expressions").size(), 3u);
  SceneOptions show;
  show.colorSkinByPart = show.props = show.hulls = show.contacts = show.ground = false;
  show.transparent = true;
  std::vector<Image> own, its;
  for (int e = -1; e < 2; ++e) {
    scene.chooseExpression(e);
    own.push_back(pictures.draw(scene.of(run->session, show, camera.eye), show, camera));
    its.push_back(test::valueOf(readPng(kPictures / fmt::format("expression_{}.png", e + 1))));
    const test::Likeness like = layerLikeness(own.back(), own.back(), its.back(), its.back());
    const test::Likeness unlike = layerLikeness(own.back(), own.back(), its.front(), its.front());
    fmt::print("{}: silhouettes {:.2f} % alike; against none {:.2f} %\n",
               result["expressions"][e + 1].get<std::string>(), 100.0 * like.silhouettes, 100.0 * unlike.silhouettes);
    EXPECT_GT(like.silhouettes, 0.99);
    if (e == 0) {
      EXPECT_LT(unlike.silhouettes, 0.975) << "the belly is not seen";
    }
  }
}

}  // namespace
}  // namespace lorica
