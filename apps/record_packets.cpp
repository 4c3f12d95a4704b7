#include "apps/interrupt.h"
#include "apps/record.h"
#include "apps/report.h"
#include "capture/streams/packet_file.h"
#include "capture/streams/udp.h"
#include "capture/streams/vmc_writer.h"
#include "geometry/descriptor.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/hard_stop.h"
#include "geometry/new_file.h"
#include "geometry/text.h"
#include "prepare/cast.h"

#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

namespace lorica {
namespace {

namespace fs = std::filesystem;

/// How long the socket is waited for before Ctrl-C is looked for [s].
constexpr double kPollSeconds = 0.1;

Error cannotWrite(const fs::path& file, int error) {
  return unwritable("{}: {}", file.string(), std::generic_category().message(error));
}

/// A .pcap file that grows. Each packet is handed to the system at once, so that a killed program loses none.
class PacketWriter {
 public:
  [[nodiscard]] static Result<std::unique_ptr<PacketWriter>> create(const fs::path& file, Host& host) {
    const fs::path part = fs::path(file).replace_extension(".part.pcap");
    LORICA_TRY(const std::optional<fs::path> found, keepFound(part));
    warnOfFound(found, host);
    LORICA_TRY(const int descriptor, createPart(part));
    std::unique_ptr<PacketWriter> writer(new PacketWriter(file, part, descriptor));
    LORICA_TRY_DO(writer->write(packetFileHeader()));
    return writer;
  }
  ~PacketWriter() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  PacketWriter(const PacketWriter&) = delete;
  PacketWriter& operator=(const PacketWriter&) = delete;

  /// @return false if the file is as large as those that are read: nothing was added
  Result<bool> add(const std::string& record) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (descriptor_ < 0) return true;  // the program is being ended
    if (bytes_ + record.size() > kMaxFileBytes) return false;
    ++packets_;
    LORICA_TRY_DO(write(record));
    return true;
  }
  [[nodiscard]] int packets() const { return packets_; }

  /// Renames the file; without packets it is removed. Further calls do nothing.
  Result<void> finish() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (descriptor_ < 0) return {};
    std::error_code failed;
    if (packets_ == 0) {
      close(std::exchange(descriptor_, -1));
      fs::remove(part_, failed);
      return {};
    }
    const bool kept = fsync(descriptor_) == 0 || errno == EINVAL;
    const int error = errno;
    close(std::exchange(descriptor_, -1));
    if (!kept) return cannotWrite(part_, error);
    fs::rename(part_, file_, failed);
    return failed ? cannotWrite(file_, failed.value()) : Result<void>();
  }

 private:
  PacketWriter(fs::path file, fs::path part, int descriptor)
      : file_(std::move(file)), part_(std::move(part)), descriptor_(descriptor) {}

  Result<void> write(const std::string& bytes) {
    const int error = writeAll(descriptor_, bytes, &bytes_);
    return error == 0 ? Result<void>() : cannotWrite(part_, error);
  }

  fs::path file_, part_;
  std::mutex mutex_;  ///< of the file
  int descriptor_;
  int packets_ = 0;
  std::uint64_t bytes_ = 0;
  AtHardStop finishing_{[this] { (void)finish(); }};
};

std::uint64_t microsecondsNow() {
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(since).count();
}

}  // namespace

Result<void> recordPackets(const SessionRecording& options, const CommonOptions& common, Host& host,
                           const std::function<Result<void>()>& finished) {
  const std::string &out = options.out, &listenAt = options.live.vmc.listenAt;
  LORICA_TRY_DO(checkJsonOutput(common, {out}));
  LORICA_TRY_DO(checkOutput(common, "OUT", out, ".pcap"));
  if (listenAt.empty()) return invalidArgument("{}: packets come from a program, expected --vmc PORT", out);
  if (listenAt.find(',') != std::string::npos) {
    return invalidArgument("--vmc {}: a file holds the packets of one program, expected one PORT", listenAt);
  }
  const Result<NetworkAddress> address = parseNetworkAddress(listenAt, false);
  LORICA_TRY(UdpSocket socket, prefixed("--vmc", address ? UdpSocket::listen(*address) : address.error()));
  LORICA_TRY(const std::unique_ptr<PacketWriter> writer, PacketWriter::create(out, host));

  host.tell(fmt::format("Recording what is sent to {}; press Ctrl-C to stop.", textOf(*address)));
  std::vector<std::byte> memory(kLargestPacket);
  std::optional<std::uint64_t> first;
  double seconds = 0.0;
  bool full = false;
  while (!host.cancelled()) {
    const std::optional<UdpSocket::Packet> packet = socket.receive(memory, kPollSeconds);
    const std::uint64_t now = microsecondsNow();
    if (packet) {
      if (!first) first = now;
      const std::string record = packetRecord(std::span(memory).first(packet->size), now, packet->port, address->port);
      LORICA_TRY(const bool added, writer->add(record));
      if (!added) {
        full = true;
        break;
      }
    }
    seconds = first ? 1e-6 * (now - *first) : 0.0;
    if (options.seconds > 0.0 && seconds >= options.seconds) break;
  }
  answerInterrupt();
  LORICA_TRY_DO(writer->finish());
  const int packets = writer->packets();
  if (packets == 0) return cancelled();
  Report report(fmt::format("Recorded {} to {} ({:.1f} s)", counted(packets, "packet"), textOf(*address), seconds));
  if (finished) LORICA_TRY_DO(finished());
  report.line(finished ? "motion" : "packets", options.into.empty() ? out : options.into);
  if (full)
    report.note(
        fmt::format("The recording ends where its file reached {} MiB, the most that is read.", kMaxFileBytes >> 20));
  nlohmann::ordered_json json;
  json["recording"] = options.into.empty() ? out : options.into;
  json["packets"] = packets;
  json["seconds"] = seconds;
  return publish(common, report, json);
}

}  // namespace lorica
