#include "prepare/stream_motion.h"

#include "capture/streams/packet_file.h"
#include "geometry/work_budgets.h"
#include "tests/capture/streams/vmc_packet.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

namespace lorica::test {
namespace {

TEST(PacketMotion, FramesAreReadUpToTheirLimit) {
  const TemporaryFolder folder;
  std::string bytes = packetFileHeader();
  Packet hips;
  hips.bundle().bone("Hips");
  std::uint64_t microseconds = 0;
  const auto add = [&] { bytes += packetRecord(hips.bytes(), microseconds += 16'667, 5000, 39539); };
  for (std::size_t i = 0; i < kMaxStreamFrames; ++i) add();
  Host host;
  const Result<Motion> most = readPacketMotion(folder.write("most.pcap", bytes), {}, host);
  ASSERT_TRUE(most.ok()) << most.error().message;
  EXPECT_EQ(most->bones->times.size(), kMaxStreamFrames);
  add();
  const Result<Motion> more = readPacketMotion(folder.write("more.pcap", bytes), {}, host);
  ASSERT_FALSE(more.ok());
  EXPECT_NE(more.error().message.find("found 216001 frames of bones, expected at most 216000"), std::string::npos)
      << more.error().message;
}

}  // namespace
}  // namespace lorica::test
