#include "capture/streams/udp.h"
#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <string>
#include <thread>

namespace lorica::test {
namespace {

std::string freePort() {
  const Result<UdpSocket> socket = UdpSocket::listen({"127.0.0.1", 0});
  return socket ? std::to_string(socket->port()) : "";
}

/// Two Loricas: one sends a recording, the other one follows it and records a session, which replays exactly.
TEST(LiveStream, OneLoricaFollowsAnother) {
  const TemporaryFolder folder;
  const std::string body = folder.path() / "body.lorica";
  ASSERT_EQ(runLorica({"decompose", "mannequin", "--parts", "5", "--keyframes", "2", "-o", body}).exitCode, 0);
  const std::string session = folder.path() / "take.lsession";
  const std::string port = freePort();
  CommandResult live;
  std::thread receiver([&] {
    live = runLorica({"live", "--vmc", port, "--decomposition", body, "--headless", "--seconds", "5", "--record",
                      session, "--json", "-"});
  });
  const CommandResult sent =
      runLorica({"play", "wave", "--decomposition", body, "--frames", "90", "--vmc-out", "127.0.0.1:" + port});
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

TEST(LiveStream, WithoutASenderTheAvatarStandsAndStrikesNothing) {
  const CommandResult live = runLorica({"live", "--vmc", freePort(), "--headless", "--frames", "40", "--json", "-"});
  ASSERT_EQ(live.exitCode, 0) << live.err;
  EXPECT_EQ(live.json()["frames"], 40);
  EXPECT_EQ(live.json()["stream"]["frames"], 0);
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
