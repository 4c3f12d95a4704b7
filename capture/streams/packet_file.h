#pragma once

#include "geometry/result.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// A UDP packet of a recording.
struct RecordedPacket {
  double time = 0.0;         ///< since the first one; does not decrease [s]
  std::uint64_t sender = 0;  ///< a hash of its address and port
  std::size_t begin = 0;     ///< of its payload in the file
  std::size_t size = 0;      ///< of its payload [bytes]
};

/// The OSC packets of a recording of network traffic, as tcpdump, Wireshark and Lorica write them: the classic .pcap
/// format (https://datatracker.ietf.org/doc/draft-ietf-opsawg-pcap), of Ethernet, Linux "any", loopback or raw IP.
///
/// Other traffic, fragments and packets that were cut are left out, with a note. Pauses longer than 2 s are shortened
/// to that, and times that run backwards stand still.
class PacketFile {
 public:
  /// @param bytes  of the file @param name  of the file, for messages
  /// @return the packets, at least one; or an error with what was found and expected
  [[nodiscard]] static Result<PacketFile> parse(std::string bytes, const std::string& name);

  [[nodiscard]] std::span<const RecordedPacket> packets() const { return packets_; }  ///< in the order of the file
  /// What was sent, without the headers of the network.
  [[nodiscard]] std::span<const std::byte> payload(const RecordedPacket& packet) const {
    return std::as_bytes(std::span(bytes_)).subspan(packet.begin, packet.size);
  }
  /// What was left out, a sentence each
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  std::string bytes_;
  std::vector<RecordedPacket> packets_;
  std::vector<std::string> notes_;
};

/// Reads such a file, of at most 256 MiB.
[[nodiscard]] Result<PacketFile> readPacketFile(const std::filesystem::path& file);

/// The bytes that begin such a file.
[[nodiscard]] std::string packetFileHeader();
/// The bytes of one packet from 127.0.0.1 to 127.0.0.1.
/// @param microseconds  since 1970
/// @param fromPort      tells senders apart
[[nodiscard]] std::string packetRecord(std::span<const std::byte> payload, std::uint64_t microseconds,
                                       std::uint16_t fromPort, std::uint16_t toPort);

}  // namespace lorica
