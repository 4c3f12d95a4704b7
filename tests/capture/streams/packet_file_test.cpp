#include "capture/streams/packet_file.h"

#include "capture/streams/udp.h"
#include "capture/streams/vmc_receiver.h"
#include "tests/capture/streams/vmc_packet.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace lorica {
namespace {

using test::Packet;

constexpr std::size_t kFileHead = 24, kRecordHead = 16;

std::span<const std::byte> bytesOf(std::string_view text) {
  return std::as_bytes(std::span(text));
}

/// A hip height per frame, from a sender.
std::string hips(double microseconds, float height, std::uint16_t sender = 5000) {
  return packetRecord(Packet().bundle().bone("Hips", {0, height, 0, 0, 0, 0, 1}).bytes(),
                      1700000000000000u + static_cast<std::uint64_t>(microseconds), sender, 39539);
}

std::string sentenceFor(const std::string& bytes) {
  const Result<PacketFile> file = PacketFile::parse(bytes, "take.pcap");
  return file ? "none" : file.error().message;
}

TEST(PacketFile, HoldsWhatWasWritten) {
  const std::string bytes = packetFileHeader() + hips(0, 1.0f) + hips(16000, 1.1f) + hips(33000, 1.2f, 5001);
  const PacketFile file = test::valueOf(PacketFile::parse(bytes, "take.pcap"));
  ASSERT_EQ(file.packets().size(), 3u);
  EXPECT_TRUE(file.notes().empty());
  EXPECT_NEAR(file.packets()[1].time, 0.016, 1e-6);
  EXPECT_NEAR(file.packets()[2].time, 0.033, 1e-6);
  EXPECT_EQ(file.packets()[0].sender, file.packets()[1].sender);
  EXPECT_NE(file.packets()[0].sender, file.packets()[2].sender);
  const std::span<const std::byte> payload = file.payload(file.packets()[1]);
  Packet packet;
  packet.bundle().bone("Hips", {0, 1.1f, 0, 0, 0, 0, 1});
  EXPECT_TRUE(std::equal(payload.begin(), payload.end(), packet.bytes().begin(), packet.bytes().end()));
}

/// IP's checksum over a whole header is 0 (RFC 1071).
TEST(PacketFile, TheChecksumIsRight) {
  const std::string record = packetRecord(bytesOf("/abc"), 1, 2, 3);
  std::uint32_t sum = 0;
  for (std::size_t i = kRecordHead; i < kRecordHead + 20; i += 2) {
    sum += static_cast<unsigned char>(record[i]) << 8 | static_cast<unsigned char>(record[i + 1]);
  }
  EXPECT_EQ((sum & 0xffff) + (sum >> 16), 0xffffu);
}

/// The same packets as other programs write them: other byte order, nanoseconds, and link layers.
TEST(PacketFile, OtherLinkLayersAndByteOrdersAreRead) {
  const auto little = [](std::uint32_t value) {
    std::string text;
    for (int i = 0; i < 4; ++i) text += static_cast<char>(value >> 8 * i & 0xff);
    return text;
  };
  const std::string ip = packetRecord(bytesOf("/abc"), 0, 1, 2).substr(kRecordHead);
  const std::vector<std::pair<std::uint32_t, std::string>> heads = {
      {0, std::string("\2\0\0\0", 4)},
      {1, std::string(12, 'm') + std::string("\x08\0", 2)},
      {1, std::string(12, 'm') + std::string("\x81\0\0\7\x08\0", 6)},  // a VLAN
      {101, ""},
      {113, std::string(14, 'm') + std::string("\x08\0", 2)},
      {276, std::string("\x08\0", 2) + std::string(18, 'm')},
  };
  for (const std::uint32_t magic : {0xa1b2c3d4u, 0xa1b23c4du}) {
    for (const auto& [link, head] : heads) {
      std::string bytes = little(magic) + little(0x00040002) + little(0) + little(0) + little(65535) + little(link);
      const auto size = static_cast<std::uint32_t>(head.size() + ip.size());
      for (const std::uint32_t fraction : {0u, 500000u}) {
        bytes += little(7) + little(fraction) + little(size) + little(size) + head + ip;
      }
      const Result<PacketFile> file = PacketFile::parse(bytes, "take.pcap");
      ASSERT_TRUE(file) << link << ": " << file.error().message;
      ASSERT_EQ(file->packets().size(), 2u) << link;
      EXPECT_NEAR(file->packets()[1].time, magic == 0xa1b2c3d4u ? 0.5 : 0.0005, 1e-9);
      EXPECT_EQ(file->payload(file->packets()[0]).size(), 4u);
    }
  }
}

TEST(PacketFile, SixthVersionOfIpIsRead) {
  std::string record = packetRecord(bytesOf("/abc"), 0, 1, 2);
  const std::string udp = record.substr(kRecordHead + 20);
  std::string ip = "\x60" + std::string(5, '\0') + "\x11" + std::string(1, '\0') + std::string(32, 'a');
  const auto size = static_cast<char>(ip.size() + udp.size());
  const std::string sizes = std::string(3, '\0') + size + std::string(3, '\0') + size;
  const PacketFile file =
      test::valueOf(PacketFile::parse(packetFileHeader() + record.substr(0, 8) + sizes + ip + udp, "take.pcap"));
  EXPECT_EQ(file.payload(file.packets()[0]).size(), 4u);
}

TEST(PacketFile, AnythingElseIsASentence) {
  const auto says = [](const std::string& bytes, const std::string& text) {
    EXPECT_NE(sentenceFor(bytes).find(text), std::string::npos) << sentenceFor(bytes);
  };
  says("", "take.pcap: found 0 bytes, expected a .pcap file");
  says(std::string(30, 'x'), "expected a .pcap file");
  says("\x0a\x0d\x0d\x0a" + std::string(30, 'x'), "found pcapng, expected the classic format");
  says(packetFileHeader(), "found no OSC packet");
  std::string wifi = packetFileHeader();
  wifi[23] = 105;
  says(wifi + hips(0, 1), "found link layer 105, expected Ethernet");
  says(packetFileHeader() + packetRecord(bytesOf("GET / HTTP/1.1"), 0, 1, 2), "found no OSC packet");
}

TEST(PacketFile, FragmentsAndOtherTrafficAreLeftOutWithANote) {
  std::string fragment = hips(0, 1);
  fragment[kRecordHead + 6] = 0x20;  // more fragments follow
  std::string tcp = hips(0, 1);
  tcp[kRecordHead + 9] = 6;
  std::string cut = hips(0, 1);
  cut[kRecordHead + 24] = 0x7f;  // UDP's length: more than there is
  const PacketFile file =
      test::valueOf(PacketFile::parse(packetFileHeader() + fragment + tcp + cut + hips(5, 1), "take.pcap"));
  EXPECT_EQ(file.packets().size(), 1u);
  ASSERT_EQ(file.notes().size(), 1u);
  EXPECT_NE(file.notes()[0].find("3 other packets were left out"), std::string::npos);
}

TEST(PacketFile, EveryTruncationIsNotedOrReported) {
  const std::string whole = packetFileHeader() + hips(0, 1.0f) + hips(16000, 1.1f);
  const std::size_t first = kFileHead + (whole.size() - kFileHead) / 2;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::string piece(whole.data(), size);
    const Result<PacketFile> file = PacketFile::parse(piece, "take.pcap");
    ASSERT_EQ(file.ok(), size >= first) << size;
    if (!file) continue;
    EXPECT_EQ(file->packets().size(), 1u);
    EXPECT_EQ(file->notes().empty(), size == first);
  }
}

TEST(PacketFile, PausesAreShortenedAndTimeNeverRunsBackwards) {
  const PacketFile file = test::valueOf(PacketFile::parse(
      packetFileHeader() + hips(0, 1) + hips(3600e6, 1) + hips(10e6, 1) + hips(11e6, 1), "take.pcap"));
  EXPECT_EQ(file.packets()[1].time, 2.0);
  EXPECT_EQ(file.packets()[2].time, 2.0);
  EXPECT_NEAR(file.packets()[3].time, 3.0, 1e-6);
  EXPECT_EQ(file.notes().size(), 2u);
}

std::vector<BoneFrame> framesOf(const std::string& bytes, int* steps = nullptr) {
  Result<PacketFile> file = PacketFile::parse(bytes, "take.pcap");
  EXPECT_TRUE(file);
  RecordedStream stream(std::make_shared<const PacketFile>(std::move(*file)));
  std::vector<BoneFrame> frames;
  BoneFrame frame;
  int waits = 0;
  while (true) {
    const bool isNew = stream.wait(1.0 / 30.0, frame);
    if (isNew) frames.push_back(frame);
    if (!isNew && stream.ended()) break;
    ++waits;
  }
  if (steps != nullptr) *steps = waits;
  return frames;
}

TEST(RecordedStream, GivesEachFrameAtItsTimeOfArrival) {
  int steps = 0;
  const std::vector<BoneFrame> frames =
      framesOf(packetFileHeader() + hips(0, 1.0f) + hips(16000, 1.1f) + hips(1016000, 1.2f), &steps);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_NEAR(frames[1].time, 0.016, 1e-6);
  EXPECT_NEAR(frames[2].time, 1.016, 1e-6);
  EXPECT_NEAR(frames[2].pose.offset[0].y(), 1.2, 1e-6);
  EXPECT_GE(steps, 3 + 29);  // a pause is filled with steps of a thirtieth of a second
  EXPECT_LE(steps, 3 + 31);
}

/// Two senders on one port: the first is followed while it sends.
TEST(RecordedStream, OneOfTwoSendersIsFollowed) {
  std::string bytes = packetFileHeader();
  for (int i = 0; i < 30; ++i) bytes += hips(33000.0 * i, 1.0f, 5000) + hips(33000.0 * i + 1000.0, 2.0f, 6000);
  for (int i = 60; i < 70; ++i) bytes += hips(33000.0 * i, 2.0f, 6000);
  const std::vector<BoneFrame> frames = framesOf(bytes);
  ASSERT_EQ(frames.size(), 40u);
  for (std::size_t f = 0; f < frames.size(); ++f) EXPECT_EQ(frames[f].pose.offset[0].y(), f < 30 ? 1.0 : 2.0) << f;
}

/// A frame that only time ends, the last one of the file, too.
TEST(RecordedStream, SingleMessagesAtTheEndAreAFrame) {
  const std::string bytes = packetFileHeader() + packetRecord(Packet().bone("Hips").bytes(), 0, 1, 2) +
                            packetRecord(Packet().bone("Spine").bytes(), 1000, 1, 2);
  const std::vector<BoneFrame> frames = framesOf(bytes);
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_NEAR(frames[0].time, 0.001, 1e-9);
}

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
