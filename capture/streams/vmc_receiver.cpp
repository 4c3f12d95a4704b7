#include "capture/streams/vmc_receiver.h"

#include "capture/streams/vmc_names.h"
#include "geometry/counts.h"
#include "geometry/work_budgets.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

/// A frame that is not complete by itself ends after this time [s].
constexpr double kFrameSeconds = 1.0 / 90.0;
/// Bones that were not sent for this time are not waited for [s].
constexpr double kForgottenSeconds = 0.5;
/// A state that is not repeated for this time has passed, if bones keep coming [s].
constexpr double kStateSeconds = 1.0;
constexpr double kFarthest = 100.0;  ///< [m]

std::optional<Vec3> position(OscArguments& arguments) {
  Vec3 p;
  for (double& value : p) {
    const std::optional<double> number = arguments.number();
    if (!number || std::abs(*number) > kFarthest) return std::nullopt;
    value = *number;
  }
  return mirrored(p);
}

std::optional<Quat> rotation(OscArguments& arguments) {
  std::array<double, 4> xyzw{};
  for (double& value : xyzw) {
    const std::optional<double> number = arguments.number();
    if (!number) return std::nullopt;
    value = *number;
  }
  const Quat q(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
  const double length = q.norm();
  if (!(length > 0.5 && length < 2.0)) return std::nullopt;
  return mirrored(q.normalized());
}

/// A sender that is silent for this time gives way to another one [s].
constexpr double kSilentSeconds = 0.5;

}  // namespace

VmcReceiver::Taken VmcReceiver::takeBone(OscArguments arguments, double seconds) {
  const std::optional<std::string_view> name = arguments.text();
  if (!name) return Taken::kNothing;
  const std::optional<Vec3> p = position(arguments);
  const std::optional<Quat> q = rotation(arguments);
  if (!p || !q) return Taken::kNothing;
  const std::optional<HumanBone> bone = vmcBoneNamed(*name);
  if (!bone) return Taken::kState;  // an eye, the jaw, or one of another version
  const std::size_t b = ordinalOf(*bone);
  if (fresh_[b]) complete();
  pending_.rotation[b] = *q;
  pending_.offset[b] = *p;
  fresh_[b] = true;
  lastSeen_[b] = seconds;
  if (freshCount_++ == 0) firstFresh_ = seconds;
  return Taken::kBone;
}

VmcReceiver::Taken VmcReceiver::takeRoot(OscArguments arguments) {
  if (!arguments.text()) return Taken::kNothing;  // its name differs between senders
  const std::optional<Vec3> p = position(arguments);
  const std::optional<Quat> q = rotation(arguments);
  if (!p || !q) return Taken::kNothing;
  pending_.rootPosition = *p;
  pending_.rootRotation = *q;
  return Taken::kState;
}

VmcReceiver::Taken VmcReceiver::takeExpression(OscArguments arguments) {
  const std::optional<std::string_view> name = arguments.text();
  const std::optional<double> weight = arguments.number();
  if (!name || !weight) return Taken::kNothing;
  const auto known = std::find_if(expressions_.begin(), expressions_.end(),
                                  [&](const NamedWeight& expression) { return expression.name == *name; });
  const std::size_t index = known - expressions_.begin();
  if (known == expressions_.end()) {
    if (expressions_.size() == kMaxPoseExpressions || name->size() > kMaxExpressionName) return Taken::kState;
    expressions_.push_back({std::string(*name), 0.0f});
    wanted_.push_back(0.0f);
  }
  wanted_[index] = std::clamp(*weight, 0.0, 1.0);
  return Taken::kState;
}

/// loaded [calibration state, calibration mode [, tracking]], see the protocol's versions 2.5 and 2.7.
VmcReceiver::Taken VmcReceiver::takeState(OscArguments arguments) {
  constexpr double kCalibrated = 3.0;
  const std::optional<double> loaded = arguments.number();
  if (!loaded) return Taken::kNothing;
  tracking_ = *loaded != 0.0;
  stateAt_ = now_;
  const std::optional<double> calibration = arguments.number();
  (void)arguments.number();
  const std::optional<double> status = arguments.number();
  if (calibration) tracking_ = tracking_ && *calibration == kCalibrated;
  if (status) tracking_ = tracking_ && *status != 0.0;
  return Taken::kState;
}

VmcReceiver::Taken VmcReceiver::takeMessage(const OscMessage& message, double seconds) {
  const OscArguments arguments(message);
  const std::string_view address = message.address;
  if (address == "/VMC/Ext/Bone/Pos") return takeBone(arguments, seconds);
  if (address == "/VMC/Ext/Root/Pos") return takeRoot(arguments);
  if (address == "/VMC/Ext/Blend/Val") return takeExpression(arguments);
  if (address == "/VMC/Ext/Blend/Apply") {
    for (std::size_t i = 0; i < expressions_.size(); ++i) expressions_[i].weight = wanted_[i];
    return Taken::kState;
  }
  if (address == "/VMC/Ext/OK" || address == "/VMC/Ext/T") {
    if (freshCount_ > 0) complete();
    return address == "/VMC/Ext/T" ? Taken::kState : takeState(arguments);
  }
  if (address == "/VMC/Ext/VRM") {
    OscArguments rest = arguments;
    (void)rest.text();  // a path on the sender's machine, which is never opened
    const std::optional<std::string_view> title = rest.text();
    if (title && title->size() <= kMaxExpressionName && title_ != *title) title_ = *title;
    return Taken::kState;
  }
  return address.starts_with("/VMC/") ? Taken::kState : Taken::kNothing;
}

bool VmcReceiver::take(std::span<const std::byte> packet, double seconds) {
  completed_ = false;
  if (freshCount_ > 0 && seconds - firstFresh_ > kFrameSeconds) complete();
  now_ = seconds;
  OscPacket messages(packet);
  bool understood = false;
  while (const std::optional<OscMessage> message = messages.next()) {
    understood = takeMessage(*message, seconds) != Taken::kNothing || understood;
  }
  if (!understood || messages.malformed()) ++refused_;
  if (freshCount_ > 0 && messages.isBundle() && allRefreshed(seconds)) complete();
  return completed_;
}

bool VmcReceiver::wait(double seconds) {
  completed_ = false;
  if (freshCount_ > 0 && seconds - firstFresh_ > kFrameSeconds) complete();
  return completed_;
}

bool VmcReceiver::allRefreshed(double seconds) const {
  for (std::size_t b = 0; b < fresh_.size(); ++b) {
    const bool sent = pending_.rotation[b].has_value() && seconds - lastSeen_[b] < kForgottenSeconds;
    if (sent && !fresh_[b]) return false;
  }
  return true;
}

void VmcReceiver::complete() {
  frame_.time = now_;
  frame_.pose = pending_;
  frame_.tracking = tracking_ || now_ - stateAt_ > kStateSeconds;
  frame_.expressions = expressions_;
  fresh_.fill(false);
  freshCount_ = 0;
  completed_ = true;
}

bool VmcFollower::take(std::span<const std::byte> packet, std::uint64_t sender, double seconds) {
  const bool silent = seconds - lastHeard_ > kSilentSeconds;
  if (!followed_ || (silent && *followed_ != sender)) {
    followed_ = sender;
    refusedBefore_ += receiver_.refusedCount();
    receiver_ = {};
  }
  if (*followed_ != sender) {
    ++others_;
    return receiver_.wait(seconds);
  }
  ++packets_;
  const std::int64_t refused = receiver_.refusedCount();
  const bool isNew = receiver_.take(packet, seconds);
  if (receiver_.refusedCount() == refused) lastHeard_ = seconds;  // noise holds no place
  return isNew;
}

bool RecordedStream::wait(double seconds, BoneFrame& frame) {
  const double until = now_ + seconds;
  const std::span<const RecordedPacket> packets = file_->packets();
  bool isNew = false;
  while (!isNew && next_ < packets.size() && packets[next_].time <= until) {
    const RecordedPacket& packet = packets[next_++];
    now_ = packet.time;
    isNew = follower_.take(file_->payload(packet), packet.sender, now_);
  }
  if (!isNew) {
    now_ = until;
    isNew = follower_.wait(now_);
    ended_ = !isNew && next_ == packets.size();
  }
  if (isNew) frame = follower_.receiver().frame();
  return isNew;
}

}  // namespace lorica
