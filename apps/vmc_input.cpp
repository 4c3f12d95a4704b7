#include "apps/vmc_input.h"

#include "apps/options.h"
#include "apps/percentiles.h"
#include "apps/standard_streams.h"
#include "apps/stream_motion.h"
#include "geometry/errors.h"
#include "geometry/printable.h"
#include "session/stream_pose_source.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <utility>

namespace lorica {
namespace {

constexpr double kSilentSeconds = 0.5;
constexpr double kLongestWait = 1.0 / 30.0;
constexpr int kLongestDelayMs = 1000;

}  // namespace

Option* addVmcInputOptions(CommandLine& app, VmcInputOptions& options) {
  Option* vmc = app.addOption("--vmc", options.listenAt,
                              "Follow a program that sends the VMC protocol, instead of a camera. A port alone is open "
                              "to this machine only; see docs/STREAMS.md. `live` takes several, separated by commas: "
                              "an avatar for each");
  vmc->typeName("[HOST:]PORT");
  addCount(app, "--delay", options.delayMs, 0,
           "Show what is received so many milliseconds later, at an even pace, if the network is uneven [default: 0]")
      ->typeName("MS")
      ->needs(vmc);
  return vmc;
}

Result<void> checkVmcInput(const VmcInputOptions& options) {
  if (options.listenAt.empty()) {
    if (options.sender.empty()) return {};
    return invalidArgument("--sender is for a program that sends, expected --vmc");
  }
  if (options.delayMs > kLongestDelayMs) {
    return invalidArgument("--delay: found {} ms, expected at most {}", options.delayMs, kLongestDelayMs);
  }
  LORICA_TRY_DO(prefixed("--vmc", parseNetworkAddress(options.listenAt, false)));
  LORICA_TRY_DO(readSenderRest(options.sender));
  return {};
}

Result<VmcInput> VmcInput::open(const VmcInputOptions& options) {
  LORICA_TRY(const NetworkAddress address, prefixed("--vmc", parseNetworkAddress(options.listenAt, false)));
  LORICA_TRY(UdpSocket socket, prefixed("--vmc", UdpSocket::listen(address)));
  LORICA_TRY(std::optional<SenderRest> sender, readSenderRest(options.sender));
  return VmcInput(std::make_unique<VmcStream>(std::move(socket), 1e-3 * options.delayMs), "VMC on " + textOf(address),
                  std::move(sender), options.delayMs);
}

VmcInput::VmcInput(std::unique_ptr<VmcStream> stream, std::string name, std::optional<SenderRest> sender, int delayMs)
    : view_(stream.get()),
      stream_(std::move(stream)),
      name_(std::move(name)),
      sender_(std::move(sender)),
      delayMs_(delayMs) {}

Result<std::unique_ptr<PoseSource>> VmcInput::makeSource(const Character& character, bool mirror, bool leads) {
  return makeStreamPoseSource(character, std::move(stream_), {mirror, sender_, leads});
}

bool VmcInput::ready(const Session& session) const {
  return view_->ready() || session.frameCount() == 0 || view_->now() - session.time() > kLongestWait;
}

void VmcInput::add(const Session& session) {
  const std::optional<VmcStream::Given> last = view_->lastGiven();
  const bool isNew = last && session.time() == last->time;
  const double afterHulls = session.times().physics + session.times().particles;
  if (isNew) latency_.push_back(1e6 * (view_->now() - last->arrival) - afterHulls);
  const bool hears = last && view_->now() - last->time < kSilentSeconds;
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
  json["stream"] = {{"packets", counts.packets}, {"refusedPackets", counts.refused}, {"packetsOfOthers", counts.others},
                    {"frames", counts.frames},   {"jitter", 1e6 * counts.jitter},    {"delay", delayMs_},
                    {"lateFrames", counts.late}};
  json["latency"] = {{"median", latency.median}, {"p95", latency.p95}};
}

void VmcInput::addTo(Report& report) const {
  const VmcStream::Counts counts = view_->counts();
  std::string packets = counted(counts.packets, "packet");
  if (counts.refused > 0) packets += fmt::format(", {} not understood", counts.refused);
  if (counts.others > 0) packets += fmt::format("; {} of other senders ignored", counts.others);
  report.line("stream", fmt::format("{} in {}", counted(counts.frames, "frame"), packets));
  if (counts.frames > 1) report.line("jitter", fmt::format("{:.1f} ms", 1e3 * counts.jitter));
  if (delayMs_ > 0.0) {
    report.line("delay", fmt::format("{} ms, which the latency includes; {} came later", delayMs_,
                                     counted(counts.late, "frame")));
  }
  if (latency_.empty()) return;
  const Percentiles latency = percentilesOf(latency_);
  report.line("latency", fmt::format("{:.2f} ms from a packet to its hulls; 95 % within {:.2f} ms",
                                     1e-3 * latency.median, 1e-3 * latency.p95));
}

}  // namespace lorica
