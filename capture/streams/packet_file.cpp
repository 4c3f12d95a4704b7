#include "capture/streams/packet_file.h"

#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/interrupt.h"
#include "geometry/little_endian.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <utility>

// Our own reader, because of what it leaves out: libpcap brings capture devices, a filter compiler and link layers of
// three decades. VMC needs four headers.

namespace lorica {
namespace {

constexpr std::uint32_t kMicro = 0xa1b2c3d4;
constexpr std::uint32_t kNano = 0xa1b23c4d;
constexpr std::uint32_t kNextGeneration = 0x0a0d0d0a;  ///< begins a .pcapng
constexpr std::size_t kFileHead = 24, kRecordHead = 16;
constexpr double kLongestPause = 2.0;  ///< [s]

/// Link layers that are read, see https://www.tcpdump.org/linktypes.html.
constexpr std::uint32_t kNull = 0, kEthernet = 1, kRaw = 101, kLoop = 108, kLinuxAny = 113, kLinuxAny2 = 276;
constexpr std::array<std::uint32_t, 6> kLinks = {kNull, kEthernet, kRaw, kLoop, kLinuxAny, kLinuxAny2};

std::uint16_t word16(std::string_view bytes, std::size_t at) {
  return loadBytes<std::uint16_t>(bytes.data() + at, std::endian::big);
}

/// What a frame of the link layer carries, if that is IP.
std::optional<std::string_view> ipOf(std::string_view frame, std::uint32_t link) {
  constexpr std::uint16_t kIp4 = 0x0800, kIp6 = 0x86dd, kVlan = 0x8100;
  std::size_t head = 0;
  if (link == kEthernet) {
    head = 14;
    while (frame.size() >= head && word16(frame, head - 2) == kVlan) head += 4;
  } else if (link == kLinuxAny) {
    head = 16;
  } else if (link == kLinuxAny2) {
    head = 20;
  } else if (link == kNull || link == kLoop) {
    head = 4;
  }
  if (frame.size() < head) return std::nullopt;
  if (link == kEthernet || link == kLinuxAny || link == kLinuxAny2) {
    const std::uint16_t kind = word16(frame, link == kLinuxAny2 ? 0 : head - 2);
    if (kind != kIp4 && kind != kIp6) return std::nullopt;
  }
  return frame.substr(head);
}

struct Datagram {
  std::string_view addresses;  ///< of sender and receiver
  std::string_view udp;
};

/// A whole UDP datagram in IP version 4 or 6, without extension headers.
std::optional<Datagram> datagramOf(std::string_view ip) {
  constexpr unsigned char kUdp = 17;
  if (ip.empty()) return std::nullopt;
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(ip[at]); };
  if (byte(0) >> 4 == 4 && ip.size() >= 20) {
    const std::size_t head = 4 * static_cast<std::size_t>(byte(0) & 15);
    const bool fragment = (word16(ip, 6) & 0x3fff) != 0;
    if (head < 20 || ip.size() < head || fragment || byte(9) != kUdp) return std::nullopt;
    return Datagram{ip.substr(12, 8), ip.substr(head)};
  }
  if (byte(0) >> 4 == 6 && ip.size() >= 40 && byte(6) == kUdp) return Datagram{ip.substr(8, 32), ip.substr(40)};
  return std::nullopt;
}

/// The payload, if it is whole and looks like OSC.
std::optional<std::string_view> oscOf(std::string_view udp) {
  if (udp.size() < 8) return std::nullopt;
  const std::size_t length = word16(udp, 4);
  if (length < 8 || length > udp.size()) return std::nullopt;
  const std::string_view payload = udp.substr(8, length - 8);
  if (!payload.starts_with('/') && !payload.starts_with("#bundle")) return std::nullopt;
  return payload;
}

/// A number of the file's own byte order.
class FileNumbers {
 public:
  FileNumbers(std::string_view bytes, std::endian order) : bytes_(bytes), order_(order) {}
  [[nodiscard]] std::uint32_t at(std::size_t offset) const {
    return loadBytes<std::uint32_t>(bytes_.data() + offset, order_);
  }

 private:
  std::string_view bytes_;
  std::endian order_;
};

void put(std::string& bytes, std::uint32_t value, std::size_t count) {
  for (std::size_t i = count; i-- > 0;) bytes += static_cast<char>(value >> 8 * i & 0xff);
}

}  // namespace

Result<PacketFile> PacketFile::parse(std::string bytes, const std::string& name) {
  const auto bad = [&](const std::string& what) { return badFormat("{}: {}", name, what); };
  if (bytes.size() < kFileHead)
    return bad(fmt::format("found {}, expected a .pcap file", counted(std::ssize(bytes), "byte")));
  std::endian order = std::endian::little;
  std::uint32_t magic = FileNumbers(bytes, order).at(0);
  if (magic == kNextGeneration) {
    return bad("found pcapng, expected the classic format: `editcap -F pcap` and `tcpdump -w` write it");
  }
  if (magic != kMicro && magic != kNano) magic = FileNumbers(bytes, order = std::endian::big).at(0);
  if (magic != kMicro && magic != kNano) return bad(fmt::format("found {:08x} in front, expected a .pcap file", magic));
  PacketFile file;
  file.bytes_ = std::move(bytes);
  const std::string_view all = file.bytes_;
  const FileNumbers numbers(all, order);
  const std::uint32_t link = numbers.at(20) & 0xffff;
  if (std::find(kLinks.begin(), kLinks.end(), link) == kLinks.end()) {
    return bad(
        fmt::format("found link layer {}, expected Ethernet (1), loopback (0, 108), raw IP (101) or Linux "
                    "\"any\" (113, 276)",
                    link));
  }
  const double unit = magic == kNano ? 1e-9 : 1e-6;
  std::optional<double> last;
  double time = 0.0;
  int left = 0, pauses = 0, backwards = 0;
  std::size_t at = kFileHead;
  while (all.size() - at >= kRecordHead) {
    const double stamp = numbers.at(at) + unit * numbers.at(at + 4);
    const std::size_t size = numbers.at(at + 8);
    if (size > all.size() - at - kRecordHead) break;
    if (workStopped()) return cancelled();
    const std::string_view frame = all.substr(at + kRecordHead, size);
    at += kRecordHead + size;
    const std::optional<std::string_view> ip = ipOf(frame, link);
    const std::optional<Datagram> datagram = ip ? datagramOf(*ip) : std::nullopt;
    const std::optional<std::string_view> osc = datagram ? oscOf(datagram->udp) : std::nullopt;
    if (!osc) {
      ++left;
      continue;
    }
    const double step = last ? stamp - *last : 0.0;
    pauses += step > kLongestPause ? 1 : 0;
    backwards += step < 0.0 ? 1 : 0;
    time += std::clamp(step, 0.0, kLongestPause);
    last = stamp;
    const std::uint64_t sender = contentHash(datagram->udp.substr(0, 2), contentHash(datagram->addresses));
    file.packets_.push_back({time, sender, static_cast<std::size_t>(osc->data() - all.data()), osc->size()});
  }
  if (file.packets_.empty()) return bad("found no OSC packet, expected at least one");
  if (at < all.size()) {
    file.notes_.push_back(counted(std::int64_t(all.size() - at), "byte at the end is", "bytes at the end are") +
                          " an incomplete packet, which was dropped");
  }
  if (left > 0)
    file.notes_.push_back(counted(std::int64_t(left), "other packet was left out: no whole OSC packet",
                                  "other packets were left out: no whole OSC packets"));
  if (pauses > 0)
    file.notes_.push_back(fmt::format("{} shortened to {:g} s",
                                      counted(std::int64_t(pauses), "pause was", "pauses were"), kLongestPause));
  if (backwards > 0)
    file.notes_.push_back(
        fmt::format("time runs backwards at {}; it stands still there", counted(std::int64_t(backwards), "packet")));
  return file;
}

Result<PacketFile> readPacketFile(const std::filesystem::path& file) {
  LORICA_TRY(std::string bytes, readFile(file));
  return PacketFile::parse(std::move(bytes), file.string());
}

std::string packetFileHeader() {
  constexpr std::uint32_t kLongest = 262144;
  std::string bytes;
  for (const std::uint32_t word : {kMicro, 0x00020004u, 0u, 0u, kLongest, kRaw}) put(bytes, word, 4);
  return bytes;
}

std::string packetRecord(std::span<const std::byte> payload, std::uint64_t microseconds, std::uint16_t fromPort,
                         std::uint16_t toPort) {
  constexpr std::uint64_t kMillion = 1000000;
  constexpr std::uint32_t kLoopback = 0x7f000001;
  constexpr std::size_t kHeads = 28;
  const std::uint32_t size = kHeads + payload.size();
  std::string ip;
  put(ip, 0x4500, 2);
  put(ip, size, 2);
  put(ip, 0, 4);       // no fragment
  put(ip, 0x4011, 2);  // 64 hops, UDP
  put(ip, 0, 2);       // the checksum, below
  put(ip, kLoopback, 4);
  put(ip, kLoopback, 4);
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < ip.size(); i += 2) sum += word16(ip, i);
  sum = (sum & 0xffff) + (sum >> 16);
  sum = ~(sum + (sum >> 16)) & 0xffff;
  ip[10] = sum >> 8;
  ip[11] = sum & 0xff;
  put(ip, fromPort, 2);
  put(ip, toPort, 2);
  put(ip, size - 20, 2);
  put(ip, 0, 2);  // no checksum
  std::string bytes;
  put(bytes, microseconds / kMillion, 4);
  put(bytes, microseconds % kMillion, 4);
  put(bytes, size, 4);
  put(bytes, size, 4);
  bytes += ip;
  bytes.append(reinterpret_cast<const char*>(payload.data()), payload.size());
  return bytes;
}

}  // namespace lorica
