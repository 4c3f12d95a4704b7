#include "capture/sensor/oni_file.h"
#include "capture/streams/depth_stream.h"
#include "capture/streams/osc.h"
#include "capture/streams/udp.h"
#include "geometry/descriptor.h"
#include "geometry/files.h"
#include "session/recording/session_file.h"
#include "skinning/skeleton.h"
#include "tests/apps/refusals.h"
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cctype>
#include <chrono>
#include <csignal>
#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace lorica::test {
namespace {

CommandSurroundings before(const std::string& virtualCamera) {
  CommandSurroundings surroundings;
  surroundings.virtualCamera = virtualCamera;
  return surroundings;
}

TEST(Live, AVirtualPersonIsFollowed) {
  const TemporaryFolder folder;
  const nlohmann::json json = jsonOf({"live", "--virtual", "--motion", "wave", "--decomposition", mannequinBody(folder),
                                      "--frames", "30", "--headless"});
  EXPECT_GT(json["depthFrames"].get<int>(), 20);
  EXPECT_GT(json["framesWithPerson"].get<int>(), 20);
  EXPECT_EQ(json["maxPeople"], 1);
  EXPECT_EQ(json["unplugged"], 0);
  // bench/tracking measures how soon; a busy machine drops images here.
  EXPECT_GE(json["firstPose"].get<double>(), 0.0);
  EXPECT_GE(json["latency"]["median"].get<double>(), json["tracking"]["median"].get<double>());
}

TEST(Live, AwayFromTheRecordingsItTrainsOnTheSameMotions) {
  const TemporaryFolder folder;
  CommandSurroundings moved;
  moved.recordings = "/nowhere";
  const nlohmann::json live = jsonOf({"live", "--virtual", "--motion", "wave", "--frames", "3", "--headless"}, moved);
  EXPECT_EQ(live["parts"], 16);
  const auto hashOf = [](const CommandSurroundings& surroundings) {
    const nlohmann::json made = jsonOf({"decompose", "mannequin", "--parts", "3", "--keyframes", "4"}, surroundings);
    return made["hash"];
  };
  EXPECT_EQ(hashOf(moved), hashOf({}));
}

TEST(Live, AnUnpluggedSensorIsSurvivedAndComesBack) {
  const TemporaryFolder folder;
  CommandSurroundings unplugged = before("unplug=1.5:3.5");
  unplugged.interruptWhen = [](const RunningCommand& command) {
    return command.err.find("the sensor is back") != std::string::npos &&
           command.err.find("a person is tracked") != std::string::npos;
  };
  const CommandResult result = runLorica(
      {"live", "--virtual", "--decomposition", mannequinBody(folder), "--headless", "--json", "-"}, unplugged);
  ASSERT_EQ(result.exitCode, 0) << result.err;
  const nlohmann::json json = result.json();
  EXPECT_EQ(json["unplugged"], 1) << result.err;
  EXPECT_TRUE(has(result.err, "the sensor is back"));
  EXPECT_GT(json["framesWithPerson"].get<int>(), 0);
}

TEST(Live, CtrlCEndsItWithASummary) {
  const TemporaryFolder folder;
  CommandSurroundings surroundings;
  surroundings.interruptWhen = [](const RunningCommand& command) {
    return command.err.find("a person is tracked") != std::string::npos;
  };
  const CommandResult result =
      runLorica({"live", "--virtual", "--decomposition", mannequinBody(folder), "--headless"}, surroundings);
  EXPECT_EQ(result.exitCode, 0) << result.err;
  EXPECT_TRUE(has(result.out, "latency"));
}

/// Sends a shipped recording at its own pace, again and again, until nobody reads any more.
void sendDepthTo(const std::string& pipe) {
  const int out = open(pipe.c_str(), O_WRONLY | O_CLOEXEC);
  const std::unique_ptr<OniFile> source = valueOf(openOni(recordingsFolder() / "wave_depth.oni"));
  const DepthCamera& camera = source->camera();
  const DepthLens lens = DepthLens::pinhole(camera.width, camera.height, camera.horizontalFov, camera.verticalFov);
  DepthFrame frame;
  for (int error = 0; error == 0; std::this_thread::sleep_for(std::chrono::milliseconds(30))) {
    if (valueOf(source->next(frame)) != DepthRead::kFrame) {
      source->seek(0);
      continue;
    }
    const auto header = depthHeaderOf(lens, frame.time);
    std::string bytes(reinterpret_cast<const char*>(header.data()), header.size());
    error = writeAll(out, bytes.append(reinterpret_cast<const char*>(frame.depthMm.data()), 2 * frame.depthMm.size()));
  }
  close(out);
}

TEST(Live, AnotherProgramSendsItsDepth) {
  signal(SIGPIPE, SIG_IGN);
  const TemporaryFolder folder;
  const std::string pipe = folder.path() / "depth", oni = folder.path() / "sent.oni";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const auto during = [&](const std::vector<std::string>& words, const CommandSurroundings& surroundings) {
    std::thread sender([&] { sendDepthTo(pipe); });
    const CommandResult result = runLorica(words, surroundings);
    sender.join();
    EXPECT_EQ(result.exitCode, 0) << result.err;
    EXPECT_TRUE(has(result.err, "Waiting for depth images from " + pipe));
    return result.json();
  };
  CommandSurroundings surroundings;
  surroundings.interruptWhen = [](const RunningCommand& command) {
    return command.err.find("a person is tracked") != std::string::npos;
  };
  const nlohmann::json json = during(
      {"live", "--depth", pipe, "--decomposition", mannequinBody(folder), "--headless", "--json", "-"}, surroundings);
  EXPECT_EQ(json["source"], "depth from " + pipe);
  EXPECT_GT(json["framesWithPerson"].get<int>(), 0);
  EXPECT_EQ(json["depthStream"]["senders"], 1);
  EXPECT_EQ(json["depthStream"]["broken"], 0);
  EXPECT_EQ(json["depthStream"]["refused"], 0);
  EXPECT_GE(json["depthStream"]["images"].get<int>(),
            json["depthFrames"].get<int>() + json["depthStream"]["dropped"].get<int>());
  // The same to a file, whose joints are those of all its images.
  const nlohmann::json recorded = during({"record", oni, "--depth", pipe, "--frames", "50", "--json", "-"}, {});
  EXPECT_EQ(recorded["frames"], 50);
  EXPECT_GT(recorded["skeletons"].get<int>(), 10);
  EXPECT_EQ(jsonOf({"info", oni})["frames"], 50);
  const CommandResult joints = runLorica({"convert", oni, folder.path() / "again.csv", "--camera-frame"});
  EXPECT_EQ(joints.exitCode, 0) << joints.err;
}

TEST(Live, WrongSourcesAreRefusedInASentence) {
  expectRefused(runLorica({"live", "--headless", "--frames", "5"}), {"--virtual"});
  expectRefused(runLorica({"live", "--virtual", "--motion", "flying", "--headless", "--frames", "5"}), {"flying"});
  expectRefused(runLorica({"live", "--driver", "nowhere/libX.so.0", "--headless", "--frames", "5"}), {"libX.so.0"});
  EXPECT_EQ(runLorica({"live", "--motion", "walk"}).exitCode, 2) << "--motion is for the virtual camera";
  expectRefused(runLorica({"live", "--webcam"}), {"lorica live --vmc 39539", "docs/RECIPES.md"});
  expectRefused(runLorica({"live", "--headless", "--depth", "70000"}), {"--depth", "70000"});
  expectRefused(runLorica({"live", "--headless", "--depth", "-", "--depth-format", "gray16le,9"}), {"--depth-format"});
  expectRefused(runLorica({"live", "--headless", "--depth", "/etc/passwd"}), {"found a file"});
}

TEST(Record, WhatAVirtualCameraSawCanBePlayed) {
  const TemporaryFolder folder;
  const std::filesystem::path out = folder.path() / "seen.oni";
  // Each image once, however slow the machine: people are found after half a second of theirs.
  const CommandResult recorded =
      runLorica({"record", out, "--virtual", "--frames", "40", "--json", "-"}, before("pace=fast"));
  ASSERT_EQ(recorded.exitCode, 0) << recorded.err;
  const int frames = recorded.json()["frames"];
  EXPECT_GE(frames, 40);
  EXPECT_GT(recorded.json()["skeletons"].get<int>(), 10);
  EXPECT_EQ(filesIn(folder.path()), (std::vector<std::string>{"seen.csv", "seen.oni"}));

  EXPECT_EQ(jsonOf({"info", out})["frames"], frames);
  const std::string body = mannequinBody(folder);
  const nlohmann::json played = jsonOf({"play", out, "--decomposition", body});
  EXPECT_EQ(played["frames"], frames) << "every frame once";
  const CommandResult again = runLorica({"play", out, "--decomposition", body, "--json", "-"});
  EXPECT_EQ(again.json()["hash"], played["hash"]);
  EXPECT_EQ(jsonOf({"info", folder.path() / "seen.csv"})["kind"], "recording");
}

TEST(Record, TheShippedRecordingIsPlayedByItsName) {
  const TemporaryFolder folder;
  const nlohmann::json result = jsonOf({"play", "wave_depth", "--decomposition", mannequinBody(folder)});
  EXPECT_EQ(result["frames"], jsonOf({"info", "wave_depth"})["frames"]);
}

TEST(Record, JointsOfAnotherOriginAreNotOverwritten) {
  const TemporaryFolder folder;
  const std::filesystem::path mine = folder.write("body.csv", "mine");
  expectRefused(runLorica({"record", folder.path() / "body.oni", "--virtual", "--frames", "3"}), {"body.csv"});
  EXPECT_EQ(readFile(mine).value(), "mine");
}

TEST(Record, ADamagedRecordingIsASentence) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "broken.oni";
  ASSERT_TRUE(writeFileAtomically(file, "NI10 and then nothing of use").ok());
  for (const char* command : {"play", "info"}) {
    const CommandResult result = runLorica({command, file});
    EXPECT_EQ(result.exitCode, 2) << command;
    EXPECT_TRUE(has(result.err, "broken.oni"));
  }
}

std::string freePort() {
  const Result<UdpSocket> socket = UdpSocket::listen({"127.0.0.1", 0});
  return socket ? std::to_string(socket->port()) : "";
}

/// Nothing falls on whoever is followed, until props are asked for; what is played keeps the demo's.
TEST(Live, StandsOnAnEmptyStageUntilPropsAreAskedFor) {
  const TemporaryFolder folder;
  const std::string body = mannequinBody(folder);
  const std::string session = folder.path() / "take.lsession";
  using Words = std::vector<std::string>;
  const auto sceneOf = [&](const Words& command, const Words& asked) {
    Words words = command;
    words.insert(words.end(), asked.begin(), asked.end());
    words.insert(words.end(), {"--decomposition", body, "--frames", "2", "--force"});
    const CommandResult made = runLorica(words);
    EXPECT_EQ(made.exitCode, 0) << made.err;
    EXPECT_EQ(has(made.out, "contacts"), command[0] == "live" && !asked.empty()) << made.out;
    return valueOf(readSession(session)).header.scene;
  };
  for (const Words& command :
       {Words{"live", "--virtual", "--headless", "--record", session},
        Words{"live", "--vmc", freePort(), "--headless", "--record", session}, Words{"record", session, "--virtual"}}) {
    EXPECT_EQ(sceneOf(command, {}), "none") << command[0];
    EXPECT_EQ(sceneOf(command, {"--scene", "demo"}), "") << command[0];
    EXPECT_EQ(sceneOf(command, {"--scene", "bowling"}), "bowling") << command[0];
  }
  EXPECT_EQ(sceneOf({"record", session, "wave"}, {}), "");
}

/// Waits until a program listens there.
void awaitListener(const std::string& port) {
  const std::string address = fmt::format("0100007F:{:04X} ", std::stoi(port));
  for (;;) {
    std::ifstream table("/proc/net/udp");
    const std::string text{std::istreambuf_iterator<char>(table), {}};
    if (text.find(address) != std::string::npos) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

/// Interrupts a receiver when nothing more is sent to it.
CommandSurroundings untilNobodySends(const std::atomic<bool>& sent) {
  CommandSurroundings surroundings;
  surroundings.interruptWhen = [&sent](const RunningCommand& command) {
    return sent && command.err.find("No program is sending any more.") != std::string::npos;
  };
  return surroundings;
}

/// Two Loricas: one sends a recording, the other one follows it and records a session, which replays exactly.
TEST(LiveStream, OneLoricaFollowsAnother) {
  const TemporaryFolder folder;
  const std::string body = mannequinBody(folder);
  const std::string session = folder.path() / "take.lsession";
  const std::string port = freePort();
  CommandResult live;
  std::atomic<bool> over = false;
  std::thread receiver([&] {
    live = runLorica({"live", "--vmc", port, "--decomposition", body, "--headless", "--record", session, "--json", "-"},
                     untilNobodySends(over));
  });
  awaitListener(port);
  const CommandResult sent =
      runLorica({"play", "wave", "--decomposition", body, "--frames", "90", "--vmc-out", "127.0.0.1:" + port});
  over = true;
  receiver.join();
  EXPECT_EQ(sent.exitCode, 0) << sent.err;
  ASSERT_EQ(live.exitCode, 0) << live.err;
  const nlohmann::json json = live.json();
  EXPECT_GT(json["stream"]["frames"].get<int>(), 20);
  EXPECT_EQ(json["stream"]["refusedPackets"], 0);
  expectAll(live.err, {"A program is sending.", "No program is sending any more."});
  const nlohmann::json replayed = jsonOf({"replay", session});
  EXPECT_TRUE(replayed["same"].get<bool>());
  EXPECT_EQ(replayed["hash"], json["hash"]);
}

/// The mannequin's name of a bone that VMC names; other words as they are.
std::string humanBoneName(const std::string& word) {
  const std::optional<HumanBone> bone =
      humanBoneNamed(std::string(1, static_cast<char>(std::tolower(word[0]))) + word.substr(1));
  return bone ? std::string(nameOf(*bone)) : word;
}

/// What is sent under /VMC/Thru is what --events writes: of each contact the begin and the end.
TEST(LiveStream, ContactsAreSentAsTheyAreWritten) {
  const TemporaryFolder folder;
  const std::string body = mannequinBody(folder);
  UdpSocket socket = valueOf(UdpSocket::listen({"127.0.0.1", 0}));
  const std::string events = folder.path() / "events.jsonl";
  CommandResult sent;
  std::atomic<bool> ended = false;
  std::thread sender([&] {
    sent = runLorica({"play", "punch_and_kick", "--decomposition", body, "--frames", "60", "--events", events,
                      "--vmc-out", "127.0.0.1:" + std::to_string(socket.port()), "--vrchat", "127.0.0.1:" + freePort(),
                      "--vmt", "127.0.0.1:" + freePort(), "--json", "-"});
    ended = true;
  });
  std::multiset<std::string> heard;
  int contacts = 0, poses = 0;
  std::vector<std::byte> memory(65536);
  for (;;) {
    const bool last = ended;
    const std::optional<UdpSocket::Packet> packet = socket.receive(memory, 0.1);
    if (!packet && last) break;
    if (!packet) continue;
    OscPacket osc(std::span<const std::byte>(memory.data(), packet->size));
    const std::string_view bytes(reinterpret_cast<const char*>(memory.data()), packet->size);
    ++(bytes.find("/lorica/contact/") != std::string_view::npos ? contacts : poses);
    while (const std::optional<OscMessage> message = osc.next()) {
      if (!message->address.starts_with("/VMC/Thru/lorica/contact/") || message->address.ends_with("/stay")) continue;
      OscArguments arguments(*message);
      std::istringstream text{std::string(arguments.text().value())};
      std::string bone, other;
      text >> bone >> other;
      heard.insert(fmt::format("{} {} {}", message->address.substr(25), humanBoneName(bone), humanBoneName(other)));
    }
  }
  sender.join();
  ASSERT_EQ(sent.exitCode, 0) << sent.err;
  const nlohmann::json counts = sent.json()["sent"];
  EXPECT_EQ(counts["poses"], poses);
  EXPECT_EQ(counts["vrchat"], poses);
  EXPECT_EQ(counts["vmt"], poses);
  EXPECT_GE(contacts, counts["contacts"].get<int>());  // those that still touch end with the session
  EXPECT_GT(counts["contacts"].get<int>(), 0);
  std::multiset<std::string> written;
  std::istringstream lines(readFile(events).value());
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json event = nlohmann::json::parse(line);
    if (event["event"] == "stay") continue;
    const std::string other =
        event["kind"] == "prop" ? "prop:" + event["prop"].dump() : event["otherBone"].get<std::string>();
    written.insert(fmt::format("{} {} {}", event["event"].get<std::string>(), event["bone"].get<std::string>(), other));
  }
  EXPECT_GE(written.size(), 4u);
  EXPECT_EQ(heard, written);
}

TEST(LiveStream, TwoProgramsAreTwoAvatars) {
  const TemporaryFolder folder;
  const std::string body = mannequinBody(folder);
  const std::string session = folder.path() / "two.lsession";
  const std::vector<std::string> ports{freePort(), freePort()};
  CommandResult live;
  std::atomic<bool> over = false;
  std::thread receiver([&] {
    live = runLorica({"live", "--vmc", ports[0] + "," + ports[1], "--decomposition", body, "--headless", "--record",
                      session, "--json", "-"},
                     untilNobodySends(over));
  });
  for (const std::string& port : ports) awaitListener(port);
  std::vector<std::thread> senders;
  for (int i = 0; i < 2; ++i) {
    senders.emplace_back([&, i] {
      (void)runLorica({"play", i == 0 ? "wave" : "walk", "--decomposition", body, "--frames", "60", "--vmc-out",
                       "127.0.0.1:" + ports[static_cast<std::size_t>(i)]});
    });
  }
  for (std::thread& sender : senders) sender.join();
  over = true;
  receiver.join();
  ASSERT_EQ(live.exitCode, 0) << live.err;
  const nlohmann::json json = live.json();
  ASSERT_EQ(json["streams"].size(), 2u);
  for (const nlohmann::json& stream : json["streams"]) EXPECT_GT(stream["frames"].get<int>(), 10);
  ASSERT_EQ(json["avatars"].size(), 2u);
  EXPECT_NE(json["avatars"][0]["hash"], json["avatars"][1]["hash"]);
  const nlohmann::json replayed = jsonOf({"replay", session});
  EXPECT_EQ(replayed["hash"], json["hash"]);
}

TEST(LiveStream, WithoutASenderTheAvatarStandsAndStrikesNothing) {
  const CommandResult live = runLorica({"live", "--vmc", freePort(), "--headless", "--frames", "40", "--json", "-"});
  ASSERT_EQ(live.exitCode, 0) << live.err;
  EXPECT_EQ(live.json()["frames"], 40);
  EXPECT_EQ(live.json()["stream"]["frames"], 0);
  const std::string port = freePort();
  const CommandResult report = runLorica({"live", "--vmc", port, "--headless", "--frames", "2"});
  EXPECT_TRUE(has(report.out, "nothing came: no program sent VMC on 127.0.0.1:" + port));
}

TEST(LiveStream, APortThatIsTakenIsASentence) {
  const Result<UdpSocket> taken = UdpSocket::listen({"127.0.0.1", 0});
  ASSERT_TRUE(taken);
  const std::string port = std::to_string(taken->port());
  expectRefused(runLorica({"live", "--vmc", port, "--headless", "--frames", "1"}),
                {"--vmc: 127.0.0.1:" + port + ": cannot listen there"});
}

}  // namespace
}  // namespace lorica::test
