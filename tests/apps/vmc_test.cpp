#include "capture/streams/osc.h"
#include "capture/streams/udp.h"
#include "geometry/files.h"
#include "skinning/skeleton.h"
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cctype>
#include <chrono>
#include <fstream>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace lorica::test {
namespace {

std::string freePort() {
  const Result<UdpSocket> socket = UdpSocket::listen({"127.0.0.1", 0});
  return socket ? std::to_string(socket->port()) : "";
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
  EXPECT_NE(live.err.find("A program is sending."), std::string::npos) << live.err;
  EXPECT_NE(live.err.find("No program is sending any more."), std::string::npos) << live.err;
  const CommandResult replayed = runLorica({"replay", session, "--json", "-"});
  ASSERT_EQ(replayed.exitCode, 0) << replayed.err;
  EXPECT_TRUE(replayed.json()["same"].get<bool>());
  EXPECT_EQ(replayed.json()["hash"], json["hash"]);
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
  Result<UdpSocket> socket = UdpSocket::listen({"127.0.0.1", 0});
  ASSERT_TRUE(socket.ok());
  const std::string events = folder.path() / "events.jsonl";
  CommandResult sent;
  std::atomic<bool> ended = false;
  std::thread sender([&] {
    sent = runLorica({"play", "punch_and_kick", "--decomposition", body, "--frames", "60", "--events", events,
                      "--vmc-out", "127.0.0.1:" + std::to_string(socket->port()), "--vrchat", "127.0.0.1:" + freePort(),
                      "--json", "-"});
    ended = true;
  });
  std::multiset<std::string> heard;
  int contacts = 0, poses = 0;
  std::vector<std::byte> memory(65536);
  for (;;) {
    const bool last = ended;
    const std::optional<UdpSocket::Packet> packet = socket->receive(memory, 0.1);
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
  const CommandResult replayed = runLorica({"replay", session, "--json", "-"});
  ASSERT_EQ(replayed.exitCode, 0) << replayed.err;
  EXPECT_EQ(replayed.json()["hash"], json["hash"]);
}

TEST(LiveStream, WithoutASenderTheAvatarStandsAndStrikesNothing) {
  const CommandResult live = runLorica({"live", "--vmc", freePort(), "--headless", "--frames", "40", "--json", "-"});
  ASSERT_EQ(live.exitCode, 0) << live.err;
  EXPECT_EQ(live.json()["frames"], 40);
  EXPECT_EQ(live.json()["stream"]["frames"], 0);
  const std::string port = freePort();
  const CommandResult report = runLorica({"live", "--vmc", port, "--headless", "--frames", "2"});
  EXPECT_NE(report.out.find("nothing came: no program sent VMC on 127.0.0.1:" + port), std::string::npos) << report.out;
}

TEST(LiveStream, BadAddressesAndBonesAreASentence) {
  const auto refused = [](const std::vector<std::string>& arguments, const std::string& found) {
    const CommandResult result = runLorica(arguments);
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_NE(result.err.find(found), std::string::npos) << result.err;
  };
  refused({"live", "--vmc", "99999", "--headless"}, "--vmc: the address 99999: expected PORT or HOST:PORT");
  refused({"play", "walk", "--vmc-out", "39539"}, "--vmc-out: the address 39539: expected HOST:PORT");
  refused({"play", "walk", "--vmc-out", "127.0.0.1:39539", "--vmc-bones", "Hips,Tail"}, "--vmc-bones: found 'Tail'");
  refused({"play", "walk", "--vmc-bones", "Hips"}, "--vmc-bones requires --vmc-out");
}

TEST(LiveStream, APortThatIsTakenIsASentence) {
  const Result<UdpSocket> taken = UdpSocket::listen({"127.0.0.1", 0});
  ASSERT_TRUE(taken);
  const std::string port = std::to_string(taken->port());
  const CommandResult result = runLorica({"live", "--vmc", port, "--headless", "--frames", "1"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_NE(result.err.find("--vmc: 127.0.0.1:" + port + ": cannot listen there"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace lorica::test
