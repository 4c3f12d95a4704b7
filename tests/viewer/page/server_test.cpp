#include "viewer/page/server.h"

#include "geometry/files.h"
#include "geometry/little_endian.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"
#include "tests/viewer/page/test_client.h"
#include "viewer/page/link.h"
#include "viewer/page/page_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace lorica {
namespace {

using test::becomes;
using test::TestClient;
using test::valueOf;
using test::Watcher;
using Json = nlohmann::json;

/// A served run of one figure that the test moves.
struct Stage {
  explicit Stage(const ServeSetting& setting = {}, const ServeLimits& limits = {})
      : server(valueOf(PageServer::start(setting, limits))) {
    cast->run = 1;
    cast->hello = R"({"type":"hello","run":1})";
    cast->characters.push_back(std::make_shared<const std::string>("glTF and more"));
    server->setCast(cast);
  }
  void show(int props = 0) {
    Scene scene;
    scene.skeleton = &skeleton;
    scene.time = ++time;
    boxes.resize(props);
    for (Prop& box : boxes) box.worldFromProp.translation().x() = time;
    scene.props = boxes;
    scene.particles = grains;
    server->next().take(scene, server->layers());
    server->publish();
  }
  /// The next ones, as many as come and no more.
  [[nodiscard]] std::vector<ClientMessage> messages(std::size_t count) const {
    std::vector<ClientMessage> taken;
    EXPECT_TRUE(becomes([&] {
      server->takeMessages(taken);
      return taken.size() == count;
    }));
    taken.resize(std::max(taken.size(), count));
    return taken;
  }

  Skeleton skeleton = makeMannequin().skeleton;
  std::vector<Prop> boxes;
  std::vector<Vec3f> grains;
  double time = 0.0;
  std::shared_ptr<ServedCast> cast = std::make_shared<ServedCast>();
  std::unique_ptr<PageServer> server;
};

std::string statusOf(const std::string& answer) {
  return answer.size() > 12 ? answer.substr(9, 3) : answer;
}

TEST(Server, AnswersWithThePageAndNothingElse) {
  const Stage stage;
  const int port = stage.server->port();
  const std::string page = TestClient(port).get("/");
  EXPECT_EQ(statusOf(page), "200");
  EXPECT_NE(page.find("Content-Security-Policy: default-src 'none'"), std::string::npos);
  EXPECT_NE(page.find("X-Content-Type-Options: nosniff"), std::string::npos);
  EXPECT_NE(page.find("<!doctype html>"), std::string::npos);
  EXPECT_EQ(TestClient(port).get("/", "", "HEAD").find("<!doctype"), std::string::npos);
  EXPECT_EQ(statusOf(TestClient(port).get("/?more=1")), "200");
  EXPECT_EQ(statusOf(TestClient(port).get("/page.js")), pageBuilt() ? "200" : "404");
  EXPECT_NE(TestClient(port).get("/character/0.glb").find("glTF and more"), std::string::npos);
  for (const char* path :
       {"/none", "/../etc/passwd", "/%2e%2e/etc/passwd", "/character/1.glb", "/character/0", "/character/-1.glb",
        "/character/0.glb/", "/character/99999999999999999999.glb", "/mesh/0", "/mesh/", "//", "/page.js.map"}) {
    EXPECT_EQ(statusOf(TestClient(port).get(path)), "404") << path;
  }
  EXPECT_EQ(statusOf(TestClient(port).get("/", "", "POST")), "405");
  EXPECT_EQ(statusOf(TestClient(port).get("/live")), "426");
}

TEST(Server, BadRequestsEndTheConnection) {
  const Stage stage;
  const std::string big(20'000, 'a');
  for (const std::string& bytes :
       {std::string("no HTTP at all\r\n\r\n"), "GET /" + big + " HTTP/1.1\r\n\r\n",
        "GET / HTTP/1.1\r\nCookie: " + big + "\r\n\r\n", std::string("\x16\x03\x01\x02\x00 a TLS hello \r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nContent-Length: 18446744073709551615\r\n\r\n")}) {
    TestClient client(stage.server->port());
    client.write(bytes);
    EXPECT_EQ(client.read().find("200"), std::string::npos) << bytes.substr(0, 20);
  }
  EXPECT_EQ(statusOf(TestClient(stage.server->port()).get("/")), "200");
}

/// A page of somebody else must not read what only this machine may.
TEST(Server, OtherNamesAndOtherOriginsAreRefused) {
  const Stage stage;
  const int port = stage.server->port();
  EXPECT_EQ(statusOf(TestClient(port).get("/", "Host: evil.example\r\n")), "421");
  EXPECT_EQ(statusOf(TestClient(port).get("/", "Host: localhost:" + std::to_string(port) + "\r\n")), "200");
  const std::string protocol = "Sec-WebSocket-Protocol: lorica.live.1\r\n";
  EXPECT_EQ(statusOf(TestClient(port).watch(protocol + "Origin: http://evil.example\r\n")), "403");
  EXPECT_EQ(statusOf(TestClient(port).watch(protocol + "Origin: null\r\n")), "403");
  TestClient own(port);
  EXPECT_EQ(statusOf(own.watch(protocol + "Origin: http://" + own.host + "\r\n")), "101");
  EXPECT_EQ(statusOf(TestClient(port).watch("")), "400");
  EXPECT_EQ(statusOf(TestClient(port).watch("Sec-WebSocket-Protocol: chat\r\n")), "400");
}

TEST(Server, AClientGetsHelloThenPropsThenTheNewestFrames) {
  Stage stage;
  TestClient client(stage.server->port());
  EXPECT_EQ(statusOf(client.watch()), "101");
  EXPECT_EQ(client.next().json()["type"], "hello");
  stage.show(3);
  EXPECT_EQ(client.next().json()["props"].size(), 3u);
  EXPECT_EQ(client.next().kind, 2);
  stage.server->set(ServedText::kState, R"({"type":"state","seconds":1})");
  EXPECT_EQ(client.next().json()["seconds"], 1);
  stage.server->say(R"({"type":"notice","text":"hello"})");
  EXPECT_EQ(client.next().json()["text"], "hello");
  // Two are in flight; of what follows only the newest is sent, once there is an acknowledgement.
  stage.show(3);
  const std::uint64_t second = client.next().number();
  for (int i = 0; i < 10; ++i) stage.show(3);
  stage.server->say(R"({"type":"notice","text":"after ten"})");
  EXPECT_EQ(client.next().json()["text"], "after ten") << "no third frame is in flight";
  client.send({{"type", "ack"}, {"frame", second}});
  const TestClient::Message newest = client.next();
  ASSERT_EQ(newest.kind, 2);
  double time = 0.0;
  std::memcpy(&time, newest.bytes.data() + 24, sizeof time);
  EXPECT_EQ(time, 12.0);
}

TEST(Server, FramesOfAnotherRunWaitForItsHello) {
  Stage stage;
  Watcher client(stage.server->port());
  stage.show();
  EXPECT_EQ(client.next("frame").kind, 2);
  const auto other = std::make_shared<ServedCast>(*stage.cast);
  other->run = 2;
  other->hello = R"({"type":"hello","run":2})";
  stage.server->setCast(other);
  stage.show();
  EXPECT_EQ(client.next("hello").json()["run"], 2);
  EXPECT_EQ(client.next().json()["type"], "props") << "all that was known is void";
  const TestClient::Message frame = client.next("frame");
  EXPECT_EQ(frame.bytes[8], 2);
}

TEST(Server, MessagesComeInOrderWithTheirClient) {
  Stage stage;
  Watcher one(stage.server->port()), other(stage.server->port());
  one.send({{"set", "pause"}, {"to", true}});
  one.send({{"set", "seek"}, {"to", 1.5}});
  one.send({{"type", "ack"}, {"frame", 1}});
  const std::vector<ClientMessage> messages = stage.messages(2);
  EXPECT_EQ(messages[0].change.id, ControlId::kPause);
  EXPECT_EQ(messages[1].change.to, 1.5);
  other.send({{"set", "undo"}});
  EXPECT_NE(stage.messages(1)[0].client, messages[0].client);
  one.send({{"type", "show"}, {"layers", {"hulls"}}});
  other.send({{"type", "show"}, {"layers", {"depth"}}});
  EXPECT_TRUE(becomes([&] { return stage.server->layers() == (served::kHulls | served::kDepth); }));
}

TEST(Server, AClientThatLeavesLetsGo) {
  Stage stage;
  {
    Watcher client(stage.server->port());
    client.send({{"type", "press"}, {"origin", {0, 1, 0}}, {"direction", {0, 0, 1}}, {"forward", {0, 0, 1}}});
    (void)stage.messages(1);
  }
  EXPECT_EQ(stage.messages(1)[0].kind, ClientMessage::Kind::kGone);
  EXPECT_TRUE(becomes([&] { return stage.server->clients() == 0; }));
}

/// A client that misbehaves loses its connection, and nobody else notices.
TEST(Server, ClientsThatMisbehaveLoseTheirConnection) {
  Stage stage;
  Watcher good(stage.server->port());
  const std::vector<std::pair<const char*, std::function<void(TestClient&)>>> rows = {
      {"no JSON", [](TestClient& c) { c.sendFrame(0x81, "hello"); }},
      {"an unknown type",
       [](TestClient& c) {
         c.send({{"type", "shutdown"}});
       }},
      {"binary", [](TestClient& c) { c.sendFrame(0x82, R"({"set":"undo"})"); }},
      {"too long", [](TestClient& c) { c.sendFrame(0x81, std::string(5000, ' ')); }},
      {"not masked", [](TestClient& c) { c.sendFrame(0x81, R"({"set":"undo"})", false); }},
      {"a reserved kind", [](TestClient& c) { c.sendFrame(0x83, "{}"); }},
      {"reserved bits", [](TestClient& c) { c.sendFrame(0xf1, "{}"); }},
      {"no UTF-8", [](TestClient& c) { c.sendFrame(0x81, "\xff\xfe\xfd"); }},
      {"2^62 bytes", [](TestClient& c) { c.write(std::string("\x81\xff\x40\0\0\0\0\0\0\0\0\0\0\0", 14)); }},
      {"a flood", [](TestClient& c) {
         for (int i = 0; i < 1000; ++i) c.send({{"set", "undo"}});
       }}};
  for (const auto& [what, misbehave] : rows) {
    TestClient client(stage.server->port());
    ASSERT_EQ(statusOf(client.watch()), "101") << what;
    misbehave(client);
    for (;;) {
      const TestClient::Message message = client.next();
      if (message.kind == 0 || message.kind == 8) break;
    }
  }
  EXPECT_TRUE(becomes([&] { return stage.server->clients() == 1; }));
  stage.show();
  EXPECT_EQ(good.next("frame").kind, 2);
}

TEST(Server, OneWhoReadsNothingIsDroppedAndTheOthersWatch) {
  ServeLimits limits;
  limits.writeSeconds = 0.2;
  Stage stage({}, limits);
  Watcher asleep(stage.server->port()), awake(stage.server->port());
  ASSERT_TRUE(becomes([&] { return stage.server->clients() == 2; }));
  // Messages that it never reads, until the buffers of both kernels are full.
  const std::string text = R"({"type":"notice","text":")" + std::string(200'000, 'x') + R"("})";
  bool dropped = false;
  for (int i = 0; i < 600 && !dropped; ++i) {
    stage.server->say(text);
    ASSERT_EQ(awake.next("notice").kind, 1) << i;
    dropped = stage.server->clients() == 1;
  }
  EXPECT_TRUE(dropped || becomes([&] { return stage.server->clients() == 1; }));
}

/// A reader that takes 500 kB in 60 steps of the session, as one at 500 kB/s does, and who keeps little in its kernel.
/// Nothing here depends on the time: a step ends when the quick reader has got it, and the slow one has read its share.
TEST(Server, AReaderAt500KilobytesASecondGetsTheNewestFramesAndTheOthersAll) {
  constexpr std::size_t kShare = 500'000 / 60;
  constexpr int kSteps = 600;
  // Frames of 72 kB fit into the buffers of the server's kernel several times, of those of 720 kB not two.
  for (const int props : {3'000, 30'000}) {
    SCOPED_TRACE(props);
    ServeLimits limits;
    limits.writeSeconds = 600.0;
    limits.messagesASecond = 1'000'000;  // the quick one acknowledges more than 180 a second
    Stage stage({}, limits);
    TestClient quick(stage.server->port()), slow(stage.server->port(), false, 8 << 10);
    for (TestClient* client : {&quick, &slow}) client->watch();
    ASSERT_TRUE(becomes([&] { return stage.server->clients() == 2; }));
    const auto timeOf = [](const TestClient::Message& frame) {
      return static_cast<int>(loadLittleEndian<double>(frame.bytes.data() + 24));
    };
    const auto acknowledge = [](TestClient& client, const TestClient::Message& frame) {
      client.send({{"type", "ack"}, {"frame", frame.number()}});
    };
    stage.show(props);
    for (TestClient* client : {&quick, &slow}) {
      const TestClient::Message first = client->next("frame");
      ASSERT_EQ(first.kind, 2);
      acknowledge(*client, first);
    }

    struct Got {
      int time = 0, at = 0;  // steps: of the frame, and when all of it was read and acknowledged
    };
    std::vector<Got> got;
    std::size_t bytes = 0;
    while (stage.time < kSteps) {
      stage.show(props);
      const TestClient::Message frame = quick.next("frame");
      ASSERT_EQ(frame.kind, 2);
      ASSERT_EQ(timeOf(frame), stage.time) << "the quick one gets each";
      acknowledge(quick, frame);
      ASSERT_TRUE(slow.take(kShare));
      while (const std::optional<TestClient::Message> message = slow.taken()) {
        ASSERT_EQ(message->kind, 2);
        bytes = message->bytes.size();
        got.push_back({timeOf(*message), static_cast<int>(stage.time)});
        acknowledge(slow, *message);
      }
    }
    ASSERT_GT(bytes, 24u * props);
    const int stepsAFrame = static_cast<int>(bytes / kShare) + 1;
    ASSERT_GE(static_cast<int>(got.size()), kSteps / stepsAFrame - 2);
    for (std::size_t i = 0; i < got.size(); ++i) {
      EXPECT_LE(got[i].at - got[i].time, 2 * stepsAFrame + 2) << "frame " << i << " is no older than two take to read";
      if (i >= 1) {
        EXPECT_GT(got[i].time, got[i - 1].time);
      }
      if (i >= 2) {
        EXPECT_GE(got[i].time, got[i - 2].at) << "frame " << i << ": two are in flight, a third is not begun";
      }
      if (i >= 3) {
        EXPECT_GT(got[i].time, got[i - 1].time + stepsAFrame / 2) << "those between are skipped";
      }
    }
  }
}

/// Who acknowledges late gets fewer particles, until it is quick again.
TEST(Server, ASlowReaderGetsFewerParticles) {
  Stage stage;
  stage.grains.assign(8000, Vec3f::Zero());
  Watcher client(stage.server->port());
  client.send({{"type", "show"}, {"layers", {"particles"}}});
  ASSERT_TRUE(becomes([&] { return stage.server->layers() == served::kParticles; }));
  const auto sent = [&](int milliseconds) {
    stage.show();
    const TestClient::Message frame = client.next("frame");
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    client.send({{"type", "ack"}, {"frame", frame.number()}});
    std::size_t at = 32;
    const auto number = [&](std::size_t where) { return loadLittleEndian<std::uint32_t>(&frame.bytes[where]); };
    while ((number(at) & 0xffff) != 6) at += 8 + (number(at + 4) + 3) / 4 * 4;
    EXPECT_EQ(number(at + 8), 8000u);
    return number(at + 12);
  };
  EXPECT_EQ(sent(0), 8000u);
  EXPECT_TRUE(becomes([&] { return sent(200) < 8000; }));
  EXPECT_TRUE(becomes([&] { return sent(0) == 8000; }));
}

TEST(Server, ConnectionsThatBreakOffLeaveNothing) {
  Stage stage;
  for (int i = 0; i < 500; ++i) {
    TestClient client(stage.server->port());
    if (i % 4 == 1) client.write("GET / HT");
    if (i % 4 == 2) client.write("GET /live HTTP/1.1\r\nUpgrade: websocket\r\n");
    if (i % 4 == 3) client.watch();
  }
  EXPECT_TRUE(becomes([&] { return stage.server->clients() == 0; }));
  TestClient client(stage.server->port());
  EXPECT_EQ(statusOf(client.watch()), "101");
}

TEST(Server, NoMoreThanTheLimitWatch) {
  ServeLimits limits;
  limits.clients = 2;
  Stage stage({}, limits);
  TestClient one(stage.server->port()), two(stage.server->port());
  EXPECT_EQ(statusOf(one.watch()), "101");
  EXPECT_EQ(statusOf(two.watch()), "101");
  EXPECT_TRUE(becomes([&] { return stage.server->clients() == 2; }));
  EXPECT_EQ(statusOf(TestClient(stage.server->port()).watch()), "503");
}

TEST(Server, ASlowRequestEnds) {
  ServeLimits limits;
  limits.requestSeconds = 0.1;
  Stage stage({}, limits);
  TestClient client(stage.server->port());
  client.write("GET / HTTP/1.1\r\n");
  EXPECT_EQ(client.read(), "");
}

TEST(Server, SaysGoodbye) {
  auto stage = std::make_unique<Stage>();
  TestClient client(stage->server->port());
  client.watch();
  EXPECT_EQ(client.next("hello").kind, 1);
  stage.reset();
  const TestClient::Message last = client.next("nothing more");
  ASSERT_EQ(last.kind, 8);
  EXPECT_EQ(last.bytes.substr(2), "the session is over");
}

/// The page of a busy machine has much to read before it.
TEST(Server, WhoReadsLateIsToldThatTheSessionIsOver) {
  ServeLimits limits;
  limits.goodbyeSeconds = 600.0;
  auto stage = std::make_unique<Stage>(ServeSetting(), limits);
  TestClient client(stage->server->port(), false, 8 << 10);
  client.watch();
  EXPECT_EQ(client.next("hello").kind, 1);
  stage->server->say(R"({"type":"notice","text":")" + std::string(4'000'000, 'x') +
                     R"("})");  // no kernel keeps so much
  std::future<void> end = std::async(std::launch::async, [&] { stage.reset(); });
  EXPECT_EQ(end.wait_for(std::chrono::milliseconds(500)), std::future_status::timeout) << "it waits for the client";
  EXPECT_EQ(client.next("notice").bytes.size(), 4'000'000u + 27u);
  const TestClient::Message last = client.next();
  ASSERT_EQ(last.kind, 8);
  EXPECT_EQ(last.bytes.substr(2), "the session is over");
  client.sendFrame(0x88, last.bytes);
}

TEST(Server, ATakenPortIsAnErrorAndTheNextOneIsFound) {
  const Stage stage;
  ServeSetting setting;
  setting.port = stage.server->port();
  const Result<std::unique_ptr<PageServer>> second = PageServer::start(setting);
  ASSERT_FALSE(second.ok());
  EXPECT_NE(second.error().message.find("port " + std::to_string(setting.port)), std::string::npos);
  const Stage other;
  EXPECT_NE(other.server->port(), stage.server->port());
}

/// A server that takes files, and where it keeps them.
struct Receiver {
  explicit Receiver(const ServeLimits& limits = {}) : stage(settingIn(home.path()), limits) {}
  static ServeSetting settingIn(const std::filesystem::path& folder) {
    ServeSetting setting;
    setting.recordings = folder / "recordings";
    return setting;
  }
  /// All below the folder of the server, with what is half written.
  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(home.path())) {
      if (entry.is_regular_file()) names.push_back(entry.path());
    }
    return names;
  }
  [[nodiscard]] std::vector<ClientMessage> messages() const {
    std::vector<ClientMessage> taken;
    stage.server->takeMessages(taken);
    return taken;
  }

  test::TemporaryFolder home;
  Stage stage;
};

/// The head of a request that sends a file.
std::string put(const TestClient& client, const std::string& path, std::size_t length, const std::string& header = "") {
  return "PUT " + path + " HTTP/1.1\r\nHost: " + client.host + "\r\nContent-Length: " + std::to_string(length) +
         "\r\n" + header + "\r\n";
}
std::string answerTo(int port, const std::string& path, const std::string& bytes, const std::string& header = "") {
  TestClient client(port);
  client.write(put(client, path, bytes.size(), "Connection: close\r\n" + header) + bytes);
  return client.read();
}

TEST(SentFiles, AreKeptWholeUnderANameOfTheServer) {
  const Receiver receiver;
  const int port = receiver.stage.server->port();
  std::string bytes;
  for (std::size_t i = 0; i < 1'000'000; ++i) bytes += static_cast<char>(i * 7919 >> 5);
  EXPECT_EQ(statusOf(answerTo(port, "/open/bvh", bytes)), "202");
  EXPECT_EQ(statusOf(answerTo(port, "/open/vrm", "another")), "202");
  EXPECT_EQ(statusOf(answerTo(port, "/open/bvh", "a third")), "202");
  const std::vector<ClientMessage> messages = receiver.messages();
  ASSERT_EQ(messages.size(), 3u);
  const std::vector<std::string> endings = {"_001.bvh", "_001.vrm", "_002.bvh"},
                                 contents = {bytes, "another", "a third"};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(messages[i].change.id, ControlId::kOpen);
    EXPECT_TRUE(messages[i].change.files.at(0).ends_with(endings[i])) << messages[i].change.files.at(0);
    EXPECT_EQ(std::filesystem::path(messages[i].change.files.at(0)).parent_path(),
              receiver.stage.server->facts().sentFiles);
    EXPECT_EQ(valueOf(readFile(messages[i].change.files.at(0))), contents[i]);
  }
  EXPECT_EQ(receiver.files().size(), 3u);
}

/// The connection goes on after a file, as after any request.
TEST(SentFiles, OneConnectionSendsSeveral) {
  const Receiver receiver;
  TestClient client(receiver.stage.server->port());
  for (const char* bytes : {"one", "two"}) {
    client.write(put(client, "/open/obj", 3) + bytes);
    EXPECT_EQ(statusOf(client.read("opened.\n")), "202");
  }
  EXPECT_EQ(statusOf(client.get("/")), "200");
  EXPECT_EQ(receiver.files().size(), 2u);
}

/// Nothing is written outside the folder, and nothing of what is refused.
TEST(SentFiles, HostileNamesAndRequestsLeaveNothing) {
  const Receiver receiver;
  const int port = receiver.stage.server->port();
  for (const char* path : {"/open/", "/open/exe", "/open/lsession", "/open/oni", "/open/BVH", "/open/bvh/",
                           "/open/../../x.bvh", "/open/%2e%2e%2fx.bvh", "/open/a/b.bvh", "/open//etc/x.bvh",
                           "/open/bvh%00", "/open/.bvh", "/open/x.bvh", "/open/bvh/../glb", "/open/\\x.bvh"}) {
    EXPECT_EQ(statusOf(answerTo(port, path, "text")), "415") << path;
  }
  EXPECT_EQ(statusOf(answerTo(port, "/open/bvh", "")), "400");
  for (const char* path : {"/", "/page.js", "/character/0.glb", "/open", "/live"}) {
    EXPECT_EQ(answerTo(port, path, "text"), "") << path << ": nothing else has a body";
  }
  EXPECT_EQ(statusOf(answerTo(port, "/open/bvh", "text", "Origin: http://evil.example\r\n")), "403");
  EXPECT_EQ(statusOf(answerTo(port, "/open/bvh", "text", "Origin: null\r\n")), "403");
  {
    TestClient chunks(port);
    chunks.write("PUT /open/bvh HTTP/1.1\r\nHost: " + chunks.host +
                 "\r\nTransfer-Encoding: chunked\r\n\r\n4\r\ntext\r\n");
    EXPECT_EQ(statusOf(chunks.read("\n\n")), "411");
  }
  EXPECT_TRUE(receiver.messages().empty());
  EXPECT_TRUE(receiver.files().empty());
  const std::string own = "Origin: http://" + TestClient(port).host + "\r\n";
  EXPECT_EQ(statusOf(answerTo(port, "/open/bvh", "text", own)), "202");
}

/// It is refused by its length, before any of it comes; who sends it anyway reads the sentence.
TEST(SentFiles, ATooLargeOneIsRefusedWithASentence) {
  const Receiver receiver;
  const int port = receiver.stage.server->port();
  TestClient client(port);
  client.write(put(client, "/open/glb", kMaxSentFile + 1));
  for (int i = 0; i < 20; ++i) client.write(std::string(100'000, 'x'));
  const std::string answer = client.read("serves\n");
  EXPECT_EQ(statusOf(answer), "413");
  EXPECT_NE(answer.find("64 MiB"), std::string::npos) << answer;
  EXPECT_TRUE(receiver.files().empty());
  EXPECT_EQ(statusOf(answerTo(port, "/open/glb", "small")), "202") << "it holds nobody up";
}

TEST(SentFiles, ACutConnectionLeavesNothing) {
  const Receiver receiver;
  const int port = receiver.stage.server->port();
  for (const std::size_t sent : {0u, 1u, 999'999u}) {
    TestClient client(port);
    client.write(put(client, "/open/bvh", 1'000'000) + std::string(sent, 'x'));
  }
  EXPECT_TRUE(becomes([&] { return statusOf(answerTo(port, "/open/bvh", "whole")) == "202"; }));
  EXPECT_EQ(receiver.files().size(), 1u);
  EXPECT_EQ(receiver.messages().size(), 1u);
}

/// Memory is for one at a time; who sends slowly does not hold the others up for ever.
TEST(SentFiles, TheSecondWaitsForTheFirst) {
  ServeLimits limits;
  limits.requestSeconds = 0.1;
  limits.fileBytesASecond = 1e6;
  const Receiver receiver(limits);
  const int port = receiver.stage.server->port();
  TestClient slow(port);
  slow.write(put(slow, "/open/bvh", 200'000) + "the beginning");
  EXPECT_TRUE(becomes([&] { return statusOf(answerTo(port, "/open/bvh", "whole")) == "503"; }));
  EXPECT_EQ(slow.read(), "") << "it is cut off";
  EXPECT_TRUE(becomes([&] { return statusOf(answerTo(port, "/open/bvh", "whole")) == "202"; }));
  EXPECT_EQ(receiver.files().size(), 1u);
}

TEST(SentFiles, TheirFolderHasALimit) {
  const Receiver receiver;
  const std::filesystem::path folder = receiver.stage.server->facts().sentFiles;
  EXPECT_EQ(statusOf(answerTo(receiver.stage.server->port(), "/open/bvh", "first")), "202");
  std::ofstream(folder / "large").put('x');
  std::filesystem::resize_file(folder / "large", kMaxSentFiles - 5 - 5);  // sparse
  EXPECT_EQ(statusOf(answerTo(receiver.stage.server->port(), "/open/bvh", "fits.")), "202");
  const std::string answer = answerTo(receiver.stage.server->port(), "/open/bvh", "x");
  EXPECT_EQ(statusOf(answer), "507");
  EXPECT_EQ(answer.find(receiver.home.path()), std::string::npos) << "folders are nobody's business";
  EXPECT_EQ(receiver.files().size(), 3u);
}

/// A folder that is not this user's own, or cannot be made, is a sentence without its name.
TEST(SentFiles, AFolderThatCannotBeUsedIsASentence) {
  const Receiver receiver;
  const std::filesystem::path folder = receiver.stage.server->facts().sentFiles;
  std::ofstream(folder).put('x');
  const std::string answer = answerTo(receiver.stage.server->port(), "/open/bvh", "text");
  EXPECT_EQ(statusOf(answer), "507");
  EXPECT_EQ(answer.find(receiver.home.path()), std::string::npos) << answer;
  EXPECT_TRUE(answer.ends_with("\r\n\r\nthe folder: Not a directory\n")) << answer;
}

TEST(SentFiles, AreRefusedWithoutAFolderAndWhereFilesMayNameAny) {
  const Stage without;
  std::string answer = answerTo(without.server->port(), "/open/bvh", "text");
  EXPECT_EQ(statusOf(answer), "403");
  EXPECT_NE(answer.find("--recordings"), std::string::npos);
  const test::TemporaryFolder home;
  ServeSetting setting = Receiver::settingIn(home.path());
  setting.paths = PathTrust::kAnywhere;
  const Stage trusting(setting);
  answer = answerTo(trusting.server->port(), "/open/bvh", "text");
  EXPECT_EQ(statusOf(answer), "403");
  EXPECT_NE(answer.find("--trust-paths"), std::string::npos);
}

/// The server ends while a file comes.
TEST(SentFiles, TheEndOfTheServerLeavesNothing) {
  auto receiver = std::make_unique<Receiver>();
  TestClient client(receiver->stage.server->port());
  client.write(put(client, "/open/bvh", 1000) + "the beginning");
  EXPECT_TRUE(
      becomes([&] { return statusOf(answerTo(receiver->stage.server->port(), "/open/bvh", "whole")) == "503"; }));
  receiver->stage.server.reset();
  EXPECT_EQ(client.read(), "");
  EXPECT_TRUE(receiver->files().empty());
}

/// With --lan: TLS and a token, with a certificate in a folder of the test.
TEST(SecureServer, NothingIsSeenWithoutTheToken) {
  const test::TemporaryFolder folder;
  const Certificate made = valueOf(makeCertificate({"localhost"}));
  ServeSetting setting;
  setting.lan = true;
  setting.certificate = folder.write("certificate.pem", made.chain);
  setting.key = folder.write("key.pem", made.key);
  setting.recordings = folder.path() / "recordings";
  Stage stage(setting);
  const int port = stage.server->port();
  const std::string token = stage.server->facts().token;
  ASSERT_EQ(token.size(), 22u);
  EXPECT_TRUE(stage.server->facts().links.front().ends_with("/#" + token));
  EXPECT_EQ(stage.server->facts().fingerprint, fingerprintOf(made.chain));
  // A browser whose user leaves https:// out is sent there, and keeps the part behind #, which no server gets.
  for (const std::string path : {"/", "/live", "/character/0.glb", "/none"}) {
    const std::string plain = TestClient(port).get(path, "Authorization: Bearer " + token + "\r\n");
    const std::string there = "https://127.0.0.1:" + std::to_string(port) + path;
    EXPECT_EQ(statusOf(plain), "307");
    EXPECT_NE(plain.find("Location: " + there + "\r\n"), std::string::npos) << plain;
    EXPECT_TRUE(plain.ends_with("\r\n\r\nThis page needs https: " + there + "\n")) << plain;
  }
  EXPECT_EQ(statusOf(TestClient(port).watch("Sec-WebSocket-Protocol: lorica.live.1, token." + token + "\r\n")), "307");
  for (const char* bytes : {"\x16 no TLS", "\x16\x03\x01", "", "no HTTP\r\n\r\n"}) TestClient(port).write(bytes);
  EXPECT_EQ(statusOf(TestClient(port, true).get("/")), "200");
  EXPECT_EQ(statusOf(TestClient(port, true).get("/character/0.glb")), "401");
  EXPECT_EQ(statusOf(TestClient(port, true).get("/character/0.glb", "Authorization: Bearer wrong\r\n")), "401");
  EXPECT_EQ(statusOf(TestClient(port, true).get("/character/0.glb", "Authorization: Bearer " + token + "\r\n")), "200");
  EXPECT_EQ(statusOf(TestClient(port, true).watch()), "401");
  EXPECT_EQ(statusOf(TestClient(port, true).watch("Sec-WebSocket-Protocol: lorica.live.1, token.x" + token + "\r\n")),
            "401");
  for (const std::string& header : {std::string(), std::string("Authorization: Bearer wrong\r\n")}) {
    TestClient sender(port, true);
    sender.write(put(sender, "/open/bvh", 4, header) + "text");
    EXPECT_EQ(statusOf(sender.read("one.\n")), "401");
  }
  EXPECT_FALSE(std::filesystem::exists(stage.server->facts().sentFiles));
  TestClient sender(port, true);
  sender.write(put(sender, "/open/bvh", 4, "Authorization: Bearer " + token + "\r\n") + "text");
  EXPECT_EQ(statusOf(sender.read("opened.\n")), "202");
  TestClient client(port, true);
  EXPECT_EQ(statusOf(client.watch("Sec-WebSocket-Protocol: lorica.live.1, token." + token + "\r\n")), "101");
  stage.show();
  EXPECT_EQ(client.next("hello").kind, 1);
  EXPECT_EQ(client.next("frame").kind, 2);
}

/// Who says nothing, or nothing with the token, shares a few places; of these the oldest goes.
TEST(SecureServer, StrangersTakeNoPlaceOfThoseWhoHaveTheToken) {
  const test::TemporaryFolder folder;
  const Certificate made = valueOf(makeCertificate({"localhost"}));
  ServeSetting setting;
  setting.lan = true;
  setting.certificate = folder.write("certificate.pem", made.chain);
  setting.key = folder.write("key.pem", made.key);
  for (const auto& [strangers, ofAnAddress] : {std::pair(4, 100), {100, 4}}) {
    ServeLimits limits;
    limits.requestSeconds = 1e6;  // none is dropped for being slow
    limits.connections = 3;
    limits.strangers = strangers;
    limits.strangersOfAnAddress = ofAnAddress;
    Stage stage(setting, limits);
    const int port = stage.server->port();
    const std::string header = "Sec-WebSocket-Protocol: lorica.live.1, token." + stage.server->facts().token + "\r\n";
    std::vector<std::unique_ptr<TestClient>> silent, watching;
    for (int round = 0; round < limits.connections; ++round) {
      for (int i = 0; i < 12; ++i) silent.push_back(std::make_unique<TestClient>(port));
      watching.push_back(std::make_unique<TestClient>(port, true));
      EXPECT_EQ(statusOf(watching.back()->watch(header)), "101") << round;
    }
    EXPECT_EQ(silent.front()->read(), "") << "it was closed";
    stage.show();
    for (const std::unique_ptr<TestClient>& client : watching) EXPECT_EQ(client->next("frame").kind, 2);
  }
}

TEST(SecureServer, ACertificateThatCannotBeUsedIsAnError) {
  const test::TemporaryFolder folder;
  const Certificate one = valueOf(makeCertificate({"localhost"})), other = valueOf(makeCertificate({"localhost"}));
  ServeSetting setting;
  setting.lan = true;
  setting.certificate = folder.path() / "missing.pem";
  setting.key = setting.certificate;
  EXPECT_FALSE(PageServer::start(setting).ok());
  for (const auto& [chain, key] : {std::pair(one.chain, other.key), std::pair(std::string("text"), one.key),
                                   std::pair(one.chain, std::string("text"))}) {
    setting.certificate = folder.write("certificate.pem", chain);
    setting.key = folder.write("key.pem", key);
    const Result<std::unique_ptr<PageServer>> started = PageServer::start(setting);
    ASSERT_FALSE(started.ok());
    EXPECT_NE(started.error().message.find(".pem"), std::string::npos) << started.error().message;
  }
}

}  // namespace
}  // namespace lorica
