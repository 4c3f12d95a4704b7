#include "prepare/vmc_input.h"

#include "geometry/errors.h"
#include "geometry/text.h"
#include "prepare/stream_motion.h"
#include "session/stream_pose_source.h"

#include <fmt/format.h>

#include <utility>

namespace lorica {
namespace {

constexpr double kSilentSeconds = 0.5;
constexpr double kLongestWait = 1.0 / 30.0;
constexpr int kLongestDelayMs = 1000;

}  // namespace

Result<void> checkVmcInput(const VmcInputOptions& options, const Host& host) {
  if (options.listenAt.empty()) {
    if (options.sender.empty()) return {};
    return invalidArgument("--sender is for a program that sends, expected --vmc");
  }
  if (options.delayMs > kLongestDelayMs) {
    return invalidArgument("--delay: found {} ms, expected at most {}", options.delayMs, kLongestDelayMs);
  }
  LORICA_TRY_DO(prefixed("--vmc", parseNetworkAddress(options.listenAt, false)));
  LORICA_TRY_DO(readSenderRest(options.sender, host));
  return {};
}

Result<VmcInput> VmcInput::open(const VmcInputOptions& options, const Host& host) {
  LORICA_TRY(const NetworkAddress address, prefixed("--vmc", parseNetworkAddress(options.listenAt, false)));
  LORICA_TRY(UdpSocket socket, prefixed("--vmc", UdpSocket::listen(address)));
  LORICA_TRY(std::optional<SenderRest> sender, readSenderRest(options.sender, host));
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

void VmcInput::add(const Session& session, Host& host) {
  const std::optional<VmcStream::Given> last = view_->lastGiven();
  const bool isNew = last && session.time() == last->time;
  const double afterHulls = session.times().physics + session.times().particles;
  if (isNew) latency_.push_back(1e6 * (view_->now() - last->arrival) - afterHulls);
  const bool hears = last && view_->now() - last->time < kSilentSeconds;
  if (hears != heard_) {
    const std::string title = view_->title();
    host.tell(hears ? fmt::format("A program is sending{}.", title.empty() ? "" : ": " + printable(title))
                    : std::string("No program is sending any more."));
  }
  heard_ = hears;
}

std::string VmcInput::state() const {
  return heard_ ? "" : "no program is sending";
}

}  // namespace lorica
