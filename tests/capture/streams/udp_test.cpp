#include "capture/streams/udp.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <string>

namespace lorica {
namespace {

TEST(NetworkAddress, HostsAndPortsAreRead) {
  const auto text = [](const std::string& given) { return textOf(*parseNetworkAddress(given, false)); };
  EXPECT_EQ(text("39539"), "127.0.0.1:39539");
  EXPECT_EQ(text("0.0.0.0:1"), "0.0.0.0:1");
  EXPECT_EQ(text("studio.local:39539"), "studio.local:39539");
  EXPECT_EQ(text("[::1]:39540"), "[::1]:39540");
}

TEST(NetworkAddress, AnythingElseIsASentence) {
  for (const char* given : {"", "0", "65536", "abc", ":39539", "127.0.0.1:", "::1:39539", "39539 ", "-1", "1:2:3"}) {
    const Result<NetworkAddress> address = parseNetworkAddress(given, false);
    ASSERT_FALSE(address) << given;
    EXPECT_NE(address.error().message.find("expected PORT or HOST:PORT"), std::string::npos);
  }
  EXPECT_FALSE(parseNetworkAddress("39539", true));
}

TEST(UdpSocket, APacketArrivesWithItsBytes) {
  UdpSocket listener = test::valueOf(UdpSocket::listen({"127.0.0.1", 0}));
  UdpSocket sender = test::valueOf(UdpSocket::connect({"127.0.0.1", listener.port()}));
  const std::array<std::byte, 3> sent = {std::byte{1}, std::byte{2}, std::byte{3}};
  EXPECT_TRUE(sender.send(sent));
  std::array<std::byte, 16> memory{};
  const std::optional<UdpSocket::Packet> packet = listener.receive(memory, 100.0);
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->size, 3u);
  EXPECT_EQ(std::memcmp(memory.data(), sent.data(), 3), 0);
  EXPECT_FALSE(listener.receive(memory, 0.0));
}

TEST(UdpSocket, TwoSendersAreToldApart) {
  UdpSocket listener = test::valueOf(UdpSocket::listen({"127.0.0.1", 0}));
  Result<UdpSocket> a = UdpSocket::connect({"127.0.0.1", listener.port()});
  Result<UdpSocket> b = UdpSocket::connect({"127.0.0.1", listener.port()});
  ASSERT_TRUE(a && b);
  const std::array<std::byte, 1> sent{};
  std::array<std::byte, 16> memory{};
  std::array<std::uint64_t, 3> senders{};
  std::size_t i = 0;
  for (UdpSocket* socket : {&*a, &*b, &*a}) {
    socket->send(sent);
    const std::optional<UdpSocket::Packet> packet = listener.receive(memory, 100.0);
    ASSERT_TRUE(packet);
    senders[i++] = packet->sender;
  }
  EXPECT_NE(senders[0], senders[1]);
  EXPECT_EQ(senders[0], senders[2]);
}

TEST(UdpSocket, APortThatIsTakenIsASentence) {
  const UdpSocket first = test::valueOf(UdpSocket::listen({"127.0.0.1", 0}));
  const Result<UdpSocket> second = UdpSocket::listen({"127.0.0.1", first.port()});
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message.find("cannot listen there: Address already in use"), std::string::npos)
      << second.error().message;
}

TEST(UdpSocket, AHostThatDoesNotResolveIsASentence) {
  const Result<UdpSocket> socket = UdpSocket::connect({"no-such-host.invalid", 39539});
  ASSERT_FALSE(socket);
  EXPECT_NE(socket.error().message.find("no-such-host.invalid:39539: "), std::string::npos) << socket.error().message;
}

TEST(UdpSocket, AReceiverThatIsNotThereIsNoError) {
  std::uint16_t port = 0;
  {
    const UdpSocket gone = test::valueOf(UdpSocket::listen({"127.0.0.1", 0}));
    port = gone.port();
  }
  UdpSocket sender = test::valueOf(UdpSocket::connect({"127.0.0.1", port}));
  const std::array<std::byte, 4> sent{};
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(sender.send(sent));
}

}  // namespace
}  // namespace lorica
