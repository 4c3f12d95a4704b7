#include "apps/vmc_output.h"

#include "capture/streams/udp.h"
#include "capture/streams/vmc_names.h"
#include "capture/streams/vmc_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>

namespace lorica {
namespace {

/// Receivers expect at most 60 frames a second; times of recordings are rounded [s].
constexpr double kLeastStep = 1.0 / 60.0 - 1e-3;
/// A recording is not delayed further than this at once, so that Ctrl-C is answered [s].
constexpr double kLongestSleep = 0.2;
/// Below this trust of every part the receiver is told that tracking is lost.
constexpr double kTracked = 0.5;

class VmcOutput final : public StepWatcher {
 public:
  VmcOutput(UdpSocket socket, BonePoseReader reader, const VmcBones& bones, std::shared_ptr<StepWatcher> next)
      : socket_(std::move(socket)), reader_(std::move(reader)), writer_(bones), next_(std::move(next)) {}

  void beforeStep(Session& session) override {
    if (next_) next_->beforeStep(session);
  }

  Result<void> afterStep(const Session& session, std::span<const WorldAction> done) override {
    waitUntilDue(session.time());
    send(session);
    return next_ ? next_->afterStep(session, done) : Result<void>();
  }

  void sessionChanged() override {
    begin_.reset();
    sent_.reset();
    if (next_) next_->sessionChanged();
  }

 private:
  using Clock = std::chrono::steady_clock;

  /// Keeps pace with a session that runs faster than real time. One that was late is not hurried.
  void waitUntilDue(double time) {
    const auto after = [](Clock::time_point from, double seconds) {
      return from + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    };
    const Clock::time_point now = Clock::now();
    if (!begin_) {
      begin_ = after(now, -time);
      first_ = time;
      return;
    }
    const Clock::time_point due = after(*begin_, time);
    if (due < now) {
      begin_ = after(now, -time);
    } else {
      std::this_thread::sleep_until(std::min(due, after(now, kLongestSleep)));
    }
  }

  void send(const Session& session) {
    const double time = session.time() - first_;
    if (sent_ && time - *sent_ >= 0.0 && time - *sent_ < kLeastStep) return;
    sent_ = time;
    const std::span<const LivePart> parts = session.body().parts();
    const bool tracking =
        std::any_of(parts.begin(), parts.end(), [](const LivePart& part) { return part.trust >= kTracked; });
    socket_.send(writer_.write(reader_.read(session.pose()), {}, time, tracking));
  }

  UdpSocket socket_;
  BonePoseReader reader_;
  VmcWriter writer_;
  std::shared_ptr<StepWatcher> next_;
  std::optional<Clock::time_point> begin_;  ///< when the session's time was 0
  double first_ = 0.0;                      ///< time of the first frame [s]
  std::optional<double> sent_;              ///< time of the last packet, from the first frame on [s]
};

Result<VmcBones> bonesOf(const std::vector<std::string>& names) {
  if (names.empty()) return allVmcBones();
  VmcBones bones{};
  for (const std::string& name : names) {
    const std::optional<HumanBone> bone = vmcBoneNamed(name);
    if (!bone) {
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("--vmc-bones: found '{}', expected names of humanoid bones such as Hips, Head, "
                               "LeftUpperArm and LeftHand, separated by commas",
                               name.substr(0, 40))};
    }
    bones[static_cast<std::size_t>(*bone)] = true;
  }
  return bones;
}

}  // namespace

void addVmcOutputOptions(CommandLine& app, VmcOutputOptions& options) {
  Option* to = app.addOption("--vmc-out", options.to,
                             "Send the pose by the VMC protocol, for VSeeFace, Unity, Unreal and others, such as "
                             "127.0.0.1:39539; see docs/STREAMS.md");
  to->typeName("HOST:PORT");
  app.addOption("--vmc-bones", options.bones, "Send only these bones: Hips,Head,LeftHand [default: all]")
      ->typeName("NAME,...")
      ->separatedBy(',')
      ->needs(to);
}

Result<void> checkVmcOutput(const VmcOutputOptions& options) {
  if (options.to.empty()) return {};
  const Result<NetworkAddress> address = parseNetworkAddress(options.to, true);
  if (!address) return Error{address.error().code, "--vmc-out: " + address.error().message};
  const Result<VmcBones> bones = bonesOf(options.bones);
  return bones ? Result<void>() : bones.error();
}

Result<std::shared_ptr<StepWatcher>> makeVmcOutput(const VmcOutputOptions& options, const Character& character,
                                                   std::shared_ptr<StepWatcher> next) {
  if (options.to.empty()) return next;
  const Result<NetworkAddress> address = parseNetworkAddress(options.to, true);
  if (!address) return Error{address.error().code, "--vmc-out: " + address.error().message};
  const Result<VmcBones> bones = bonesOf(options.bones);
  if (!bones) return bones.error();
  Result<BonePoseReader> reader = BonePoseReader::create(character.skeleton);
  if (!reader) return Error{reader.error().code, "--vmc-out: " + reader.error().message};
  Result<UdpSocket> socket = UdpSocket::connect(*address);
  if (!socket) return Error{socket.error().code, "--vmc-out: " + socket.error().message};
  return std::shared_ptr<StepWatcher>(
      std::make_shared<VmcOutput>(std::move(*socket), std::move(*reader), *bones, std::move(next)));
}

}  // namespace lorica
