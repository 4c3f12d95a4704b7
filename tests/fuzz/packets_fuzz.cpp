// Recordings of network traffic (.pcap), and the frames of VMC in them.
#include "capture/streams/vmc_receiver.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lorica;
  Result<PacketFile> file = PacketFile::parse({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!file) {
    LORICA_CHECK(file.error().message.starts_with("fuzz"), "an error that does not name the file");
    return 0;
  }
  double last = 0.0;
  for (const RecordedPacket& packet : file->packets()) {
    LORICA_CHECK(packet.time >= last && packet.time <= last + 2.0, "time runs backwards or jumps");
    LORICA_CHECK(!file->payload(packet).empty(), "an empty packet");
    last = packet.time;
  }
  RecordedStream stream(std::make_shared<const PacketFile>(std::move(*file)));
  BoneFrame frame;
  while (!stream.ended()) (void)stream.wait(1.0 / 30.0, frame);
  return 0;
}
