#include "capture/streams/vmc_writer.h"

#include "capture/streams/osc.h"

#include <gtest/gtest.h>

#include <string>

namespace lorica {
namespace {

struct Heard {
  std::string address, text;
  double strength = 0.0;
};

Heard heard(const SentContact& contact) {
  ContactWriter writer;
  OscPacket packet(writer.write(contact));
  const std::optional<OscMessage> message = packet.next();
  if (!message || message->types != "sf") return {};
  OscArguments arguments(*message);
  Heard result{std::string(message->address), std::string(arguments.text().value_or("")), 0.0};
  result.strength = arguments.number().value_or(-1.0);
  EXPECT_FALSE(packet.next());
  EXPECT_FALSE(packet.malformed());
  return result;
}

TEST(ContactWriter, NamesBonePropPlaceAndStrength) {
  const Heard message = heard({"begin", "RightHand", "", 2, {-0.21, 1.34, 0.52}, 1.75});
  EXPECT_EQ(message.address, "/VMC/Thru/lorica/contact/begin");
  EXPECT_EQ(message.text, "RightHand prop:2 0.210 1.340 0.520");
  EXPECT_EQ(message.strength, 1.75);
}

TEST(ContactWriter, NamesBothBones) {
  const Heard message = heard({"end", "LeftThumbProximal", "RightThumbProximal", 0, {0.0, 1.0, -0.25}, 0.0});
  EXPECT_EQ(message.address, "/VMC/Thru/lorica/contact/end");
  EXPECT_EQ(message.text, "LeftThumbProximal RightThumbProximal -0.000 1.000 -0.250");
}

TEST(ContactWriter, PlacesBeyondMeasureAreCutShort) {
  const Heard message = heard({"stay", "Hips", "", 1, {1e200, 1e200, 1e200}, 0.5});
  EXPECT_EQ(message.text.size(), 128u);
  EXPECT_EQ(message.strength, 0.5);
}

}  // namespace
}  // namespace lorica
