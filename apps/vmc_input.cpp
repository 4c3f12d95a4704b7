#include "apps/vmc_input.h"

#include "apps/percentiles.h"
#include "apps/standard_streams.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <utility>

namespace lorica {
namespace {

constexpr double kSilentSeconds = 0.5;
constexpr double kLongestWait = 1.0 / 30.0;

}  // namespace

Result<void> checkVmcInput(const std::string& listenAt) {
  if (listenAt.empty()) return {};
  const Result<NetworkAddress> address = parseNetworkAddress(listenAt, false);
  if (!address) return Error{address.error().code, "--vmc: " + address.error().message};
  return {};
}

Result<VmcInput> VmcInput::open(const std::string& listenAt) {
  const Result<NetworkAddress> address = parseNetworkAddress(listenAt, false);
  if (!address) return Error{address.error().code, "--vmc: " + address.error().message};
  Result<UdpSocket> socket = UdpSocket::listen(*address);
  if (!socket) return Error{socket.error().code, "--vmc: " + socket.error().message};
  return VmcInput(std::make_unique<VmcStream>(std::move(*socket)), "VMC on " + textOf(*address));
}

VmcInput::VmcInput(std::unique_ptr<VmcStream> stream, std::string name)
    : view_(stream.get()), stream_(std::move(stream)), name_(std::move(name)) {}

bool VmcInput::ready(const Session& session) const {
  return view_->ready() || session.frameCount() == 0 || view_->now() - session.time() > kLongestWait;
}

void VmcInput::add(const Session& session) {
  const std::optional<double> last = view_->lastTime();
  const bool isNew = last && session.time() == *last;
  if (isNew) latency_.push_back(1e6 * (view_->now() - *last));
  const bool hears = last && view_->now() - *last < kSilentSeconds;
  if (hears != heard_) {
    const std::string title = view_->title();
    say(hears ? fmt::format("A program is sending{}.\n", title.empty() ? "" : ": " + printable(title))
              : std::string("No program is sending any more.\n"));
  }
  heard_ = hears;
}

std::string VmcInput::state() const {
  return heard_ ? "" : "no program is sending";
}

void VmcInput::addTo(nlohmann::ordered_json& json) const {
  const VmcStream::Counts counts = view_->counts();
  const Percentiles latency = percentilesOf(latency_);
  json["stream"] = {{"packets", counts.packets},
                    {"refusedPackets", counts.refused},
                    {"packetsOfOthers", counts.others},
                    {"frames", counts.frames},
                    {"jitter", 1e6 * counts.jitter}};
  json["latency"] = {{"median", latency.median}, {"p95", latency.p95}};
}

void VmcInput::addTo(Report& report) const {
  const VmcStream::Counts counts = view_->counts();
  std::string packets = counted(counts.packets, "packet");
  if (counts.refused > 0) packets += fmt::format(", {} not understood", counts.refused);
  if (counts.others > 0) packets += fmt::format("; {} of other senders ignored", counts.others);
  report.line("stream", fmt::format("{} in {}", counted(counts.frames, "frame"), packets));
  if (counts.frames > 1) report.line("jitter", fmt::format("{:.1f} ms", 1e3 * counts.jitter));
  if (latency_.empty()) return;
  const Percentiles latency = percentilesOf(latency_);
  report.line("latency", fmt::format("{:.2f} ms from a packet to its hulls; 95 % within {:.2f} ms",
                                     1e-3 * latency.median, 1e-3 * latency.p95));
}

}  // namespace lorica
