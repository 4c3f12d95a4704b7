#include "capture/streams/osc.h"

#include "geometry/random_numbers.h"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {
namespace {

using Bytes = std::vector<std::byte>;

Bytes bytesOf(std::string_view text) {
  Bytes bytes(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) bytes[i] = static_cast<std::byte>(text[i]);
  return bytes;
}

Bytes copyOf(std::span<const std::byte> packet) {
  return {packet.begin(), packet.end()};
}

/// The first example of the OSC 1.0 specification's page of examples.
const std::string kFrequency("/oscillator/4/frequency\0,f\0\0\x43\xdc\0\0", 32);
/// The second one: 1000, -1, "hello", 1.234, 5.678.
const std::string kFoo("/foo\0\0\0\0,iisff\0\0\0\0\x03\xe8\xff\xff\xff\xffhello\0\0\0\x3f\x9d\xf3\xb6\x40\xb5\xb2\x2d",
                       40);

/// Reads every message and every argument from memory of exactly the packet's size. @return the number of messages
int readAll(const Bytes& packet) {
  const auto memory = std::make_unique<std::byte[]>(packet.size());
  std::copy(packet.begin(), packet.end(), memory.get());
  OscPacket messages(std::span<const std::byte>(memory.get(), packet.size()));
  int count = 0;
  while (const std::optional<OscMessage> message = messages.next()) {
    ++count;
    OscArguments arguments(*message);
    while (arguments.left() > 0) {
      if (message->types[message->types.size() - arguments.left()] == 's') {
        (void)arguments.text();
      } else {
        (void)arguments.number();
      }
    }
  }
  return count;
}

TEST(Osc, TheSpecificationsExamplesAreRead) {
  const Bytes frequency = bytesOf(kFrequency);
  OscPacket packet(frequency);
  const std::optional<OscMessage> message = packet.next();
  ASSERT_TRUE(message);
  EXPECT_EQ(message->address, "/oscillator/4/frequency");
  OscArguments arguments(*message);
  EXPECT_EQ(arguments.number(), 440.0);
  EXPECT_FALSE(packet.next());
  EXPECT_FALSE(packet.malformed());
  EXPECT_FALSE(packet.isBundle());

  const Bytes foo = bytesOf(kFoo);
  OscPacket second(foo);
  OscArguments five(*second.next());
  EXPECT_EQ(five.left(), 5u);
  EXPECT_EQ(five.number(), 1000.0);
  EXPECT_EQ(five.number(), -1.0);
  EXPECT_EQ(five.text(), "hello");
  EXPECT_EQ(five.number(), static_cast<double>(1.234f));
  EXPECT_EQ(five.number(), static_cast<double>(5.678f));
  EXPECT_FALSE(five.number());
}

TEST(Osc, TheSpecificationsExamplesAreWritten) {
  std::array<std::byte, 64> memory{};
  OscWriter writer(memory);
  writer.beginMessage("/oscillator/4/frequency", "f");
  writer.add(440.0f);
  writer.endMessage();
  EXPECT_EQ(copyOf(writer.packet()), bytesOf(kFrequency));

  OscWriter second(memory);
  second.beginMessage("/foo", "iisff");
  second.add(std::int32_t{1000});
  second.add(std::int32_t{-1});
  second.add(std::string_view("hello"));
  second.add(1.234f);
  second.add(5.678f);
  second.endMessage();
  EXPECT_EQ(copyOf(second.packet()), bytesOf(kFoo));
}

TEST(Osc, NestedBundlesAreReadInOrder) {
  std::array<std::byte, 256> memory{};
  OscWriter inner(memory);
  inner.beginBundle();
  for (const char* address : {"/b", "/c"}) {
    inner.beginMessage(address, "");
    inner.endMessage();
  }
  const Bytes nested = copyOf(inner.packet());
  OscWriter outer(memory);
  outer.beginBundle();
  outer.beginMessage("/a", "");
  outer.endMessage();
  Bytes packet = copyOf(outer.packet());
  for (const std::size_t shift : {24u, 16u, 8u, 0u}) packet.push_back(static_cast<std::byte>(nested.size() >> shift));
  packet.insert(packet.end(), nested.begin(), nested.end());
  const Bytes last = bytesOf(std::string("\0\0\0\x08/d\0\0,\0\0\0", 12));
  packet.insert(packet.end(), last.begin(), last.end());

  OscPacket messages(packet);
  std::string addresses;
  while (const std::optional<OscMessage> message = messages.next()) addresses += message->address;
  EXPECT_EQ(addresses, "/a/b/c/d");
  EXPECT_FALSE(messages.malformed());
  EXPECT_TRUE(messages.isBundle());
}

TEST(Osc, BundlesNestedAThousandDeepAreRefused) {
  Bytes packet = bytesOf(kFrequency);
  for (int i = 0; i < 1000; ++i) {
    Bytes around = bytesOf(std::string("#bundle\0\0\0\0\0\0\0\0\x01", 16));
    for (const std::size_t shift : {24u, 16u, 8u, 0u}) around.push_back(static_cast<std::byte>(packet.size() >> shift));
    around.insert(around.end(), packet.begin(), packet.end());
    packet = std::move(around);
  }
  OscPacket messages(packet);
  EXPECT_FALSE(messages.next());
  EXPECT_TRUE(messages.malformed());
}

TEST(Osc, EveryTruncatedPrefixIsRefused) {
  for (const std::string& whole : {kFrequency, kFoo}) {
    for (std::size_t size = 1; size < whole.size(); ++size) {
      const Bytes packet = bytesOf(whole.substr(0, size));
      OscPacket messages(packet);
      const std::optional<OscMessage> message = messages.next();
      if (!message) {
        EXPECT_TRUE(messages.malformed()) << size;
        continue;
      }
      // The types promise more than there is.
      OscArguments arguments(*message);
      std::size_t read = 0;
      for (const char type : message->types)
        read += type == 's' ? arguments.text().has_value() : arguments.number().has_value();
      EXPECT_LT(read, message->types.empty() ? 1 : message->types.size()) << size;
    }
  }
}

/// Types that make other readers believe a size: two blobs of 4 GB, strings without an end, unknown letters.
TEST(Osc, PromisesThatThePacketDoesNotHoldAreNotBelieved) {
  EXPECT_EQ(readAll(bytesOf(std::string("/a\0\0,bb\0\x7f\xff\xff\xf0", 12))), 1);
  EXPECT_EQ(readAll(bytesOf(std::string("/a\0\0,ss\0abcdefgh", 16))), 1);
  EXPECT_EQ(readAll(bytesOf(std::string("/a\0\0,\xff\xfe\0", 8))), 1);
  EXPECT_EQ(readAll(bytesOf("/abc,def")), 0);
  EXPECT_EQ(readAll(bytesOf("nothing of the kind.")), 0);
  EXPECT_EQ(readAll(bytesOf(std::string("#bundle\0\0\0\0\0\0\0\0\x01\xff\xff\xff\xff", 20))), 0);
}

TEST(Osc, NumbersOfAllSizesAreRead) {
  // "/n" with a double of 0.1, an integer of 64 bits of -2, true and false, and a double whose end is missing.
  const std::string packet("/n\0\0,dhTFd\0\0\x3f\xb9\x99\x99\x99\x99\x99\x9a\xff\xff\xff\xff\xff\xff\xff\xfe\0\0\0\0",
                           32);
  OscPacket messages(std::as_bytes(std::span(packet)));
  const std::optional<OscMessage> message = messages.next();
  ASSERT_TRUE(message);
  OscArguments arguments(*message);
  for (const double expected : {0.1, -2.0, 1.0, 0.0}) EXPECT_EQ(arguments.number(), expected);
  EXPECT_FALSE(arguments.number());
}

TEST(Osc, NumbersThatAreNotFiniteAreNotRead) {
  const Bytes packet = bytesOf(std::string("/a\0\0,ff\0\x7f\xc0\0\0\x3f\x80\0\0", 16));
  OscPacket messages(packet);
  OscArguments arguments(*messages.next());
  EXPECT_FALSE(arguments.number());
  EXPECT_FALSE(arguments.number());
}

TEST(Osc, RandomlyChangedBundlesAreReadWithoutLeavingThem) {
  std::array<std::byte, 512> memory{};
  OscWriter writer(memory);
  writer.beginBundle();
  for (int i = 0; i < 4; ++i) {
    writer.beginMessage("/VMC/Ext/Bone/Pos", "sfffffff");
    writer.add(std::string_view("LeftUpperArm"));
    for (int k = 0; k < 7; ++k) writer.add(0.5f);
    writer.endMessage();
  }
  const Bytes whole = copyOf(writer.packet());
  ASSERT_EQ(readAll(whole), 4);
  RandomNumbers random(7);
  for (int trial = 0; trial < 20000; ++trial) {
    Bytes packet = whole;
    const int changes = 1 + static_cast<int>(random.between(0.0, 6.0));
    for (int i = 0; i < changes; ++i) {
      const auto at = static_cast<std::size_t>(random.unit() * static_cast<double>(packet.size()));
      packet[at] = static_cast<std::byte>(static_cast<int>(random.between(0.0, 256.0)));
    }
    EXPECT_LE(readAll(packet), 40);
  }
}

TEST(Osc, WhatDoesNotFitIsNotWritten) {
  std::array<std::byte, 40> memory{};
  OscWriter writer(memory);
  writer.beginBundle();
  writer.beginMessage("/a", "f");
  writer.add(1.0f);
  writer.endMessage();
  EXPECT_TRUE(writer.fits());
  writer.beginMessage("/much/too/long/for/this", "f");
  writer.add(1.0f);
  writer.endMessage();
  EXPECT_FALSE(writer.fits());
}

}  // namespace
}  // namespace lorica
