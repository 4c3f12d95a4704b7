#include "viewer/player/pose_output.h"

#include "capture/streams/vmc_names.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "session/contact_events.h"
#include "skinning/morphs/expressions.h"
#include "viewer/player/session_face.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
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

/// A face without a body: the weights of its expressions.
class SentFace {
 public:
  SentFace(Expressions expressions, std::vector<float> chosen)
      : expressions_(std::move(expressions)), chosen_(std::move(chosen)), face_(noMorphs_, expressions_, ahead_) {
    for (std::size_t e = 0; e < chosen_.size(); ++e) face_.set(e, chosen_[e]);
    names_.reserve(expressions_.list.size());
    for (const Expression& expression : expressions_.list) {
      names_.push_back(nameInVrm0(expression.name));  // which all receivers know
      weights_.push_back({names_.back(), 0.0f});
    }
  }
  SentFace(const SentFace&) = delete;
  SentFace& operator=(const SentFace&) = delete;

  std::span<const VmcWeight> read(const Session& session) {
    follower_.apply(session.source().expressions(), expressions_, chosen_, face_);
    FaceInput input;
    input.time = session.time();
    face_.update(input);
    for (std::size_t e = 0; e < weights_.size(); ++e) weights_[e].weight = face_.expressionWeights()[e];
    return weights_;
  }

 private:
  Morphs noMorphs_;
  LookAt ahead_;
  Expressions expressions_;
  std::vector<float> chosen_;
  Face face_;
  ExpressionFollower follower_;
  std::vector<std::string> names_;
  std::vector<VmcWeight> weights_;
};

/// The contacts of one body, each as a packet. Bones are those of VMC: of a joint that is none, the nearest one above.
class SentContacts {
 public:
  explicit SentContacts(const Session& session) : events_(session) {
    const Skeleton& skeleton = session.character().skeleton;
    names_.reserve(skeleton.jointCount());
    for (JointIndex joint = 0; joint < skeleton.jointCount(); ++joint) {
      JointIndex named = joint;
      while (named != kNoJoint && !skeleton.joint(named).bone) named = skeleton.joint(named).parent;
      names_.push_back(vmcNameOf(named == kNoJoint ? HumanBone::kHips : *skeleton.joint(named).bone));
    }
  }

  /// @return number of packets
  int send(const Session& session, UdpSocket& to) { return send(events_.update(session), to); }
  int sendEnds(UdpSocket& to) { return send(events_.endAll(), to); }

 private:
  [[nodiscard]] std::string_view nameOf(JointIndex joint) const {
    return joint == kNoJoint ? vmcNameOf(HumanBone::kHips) : names_[joint];
  }

  int send(std::span<const ContactEvent> events, UdpSocket& to) {
    int sent = 0;
    constexpr std::string_view kPhases[] = {"begin", "stay", "end"};
    for (const ContactEvent& event : events) {
      const Touch& touch = event.touch;
      const bool prop = touch.pair.kind == TouchKind::kProp;
      const bool taken = to.send(writer_.write({kPhases[static_cast<int>(event.phase)], nameOf(touch.bone),
                                                prop ? std::string_view() : nameOf(touch.otherBone), touch.pair.other,
                                                touch.point, touch.strength}));
      sent += taken ? 1 : 0;
    }
    return sent;
  }

  ContactEvents events_;
  std::vector<std::string_view> names_;
  ContactWriter writer_;
};

/// Each program that is sent to.
struct VmcReceiverAt {
  UdpSocket socket;
  VmcWriter writer;
};
struct TrackersAt {
  UdpSocket socket;
  TrackerWriter writer;
  int* sent;  ///< counts its packets
};

class PoseOutput final : public StepWatcher {
 public:
  PoseOutput(BonePoseReader reader, std::unique_ptr<SentFace> face, std::optional<VmcReceiverAt> vmc,
             std::vector<TrackersAt> trackers, std::shared_ptr<const LiveSources> live,
             std::shared_ptr<StepWatcher> next, PosesSent& sent)
      : reader_(std::move(reader)),
        face_(std::move(face)),
        vmc_(std::move(vmc)),
        trackers_(std::move(trackers)),
        live_(std::move(live)),
        next_(std::move(next)),
        packets_(sent) {}
  ~PoseOutput() override {
    if (contacts_) contacts_->sendEnds(vmc_->socket);
    for (TrackersAt& to : trackers_) {
      if (const std::span<const std::byte> end = to.writer.writeEnd(); !end.empty()) (void)to.socket.send(end);
    }
  }
  PoseOutput(const PoseOutput&) = delete;
  PoseOutput& operator=(const PoseOutput&) = delete;

  void beforeStep(Session& session) override {
    if (vmc_ && !contacts_) contacts_.emplace(session);
    if (next_) next_->beforeStep(session);
  }

  Result<void> afterStep(const Session& session, std::span<const WorldAction> done) override {
    waitUntilDue(session.time());
    send(session);
    if (vmc_) packets_.contacts += contacts_->send(session, vmc_->socket);
    return next_ ? next_->afterStep(session, done) : Result<void>();
  }

  void sessionChanged() override {
    begin_.reset();
    sent_.reset();
    if (contacts_) packets_.contacts += contacts_->sendEnds(vmc_->socket);
    contacts_.reset();
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
    const BonePose pose = reader_.read(session.pose());
    if (vmc_ && vmc_->socket.send(vmc_->writer.write(pose, face_->read(session), time, tracking))) ++packets_.vmc;
    if (trackers_.empty() || !tracking) return;
    const std::optional<StagedPerson> person = wearer();
    for (TrackersAt& to : trackers_) {
      if (to.socket.send(to.writer.write(pose, person ? &*person : nullptr))) ++*to.sent;
    }
  }

  /// The person whom the first avatar follows, if they wear a registered headset.
  [[nodiscard]] std::optional<StagedPerson> wearer() const {
    if (live_ == nullptr || live_->tracked == nullptr || !live_->tracked->sight().worn) return std::nullopt;
    const std::optional<Registration> known = live_->headset->registration();
    if (!known) return std::nullopt;
    const DepthSight& sight = live_->tracked->sight();
    return StagedPerson{live_->withHead(sight.joints), known->stageFromFloor() * Eigen::Translation3d(sight.stage)};
  }

  BonePoseReader reader_;
  std::unique_ptr<SentFace> face_;
  std::optional<VmcReceiverAt> vmc_;
  std::vector<TrackersAt> trackers_;
  std::shared_ptr<const LiveSources> live_;
  std::optional<SentContacts> contacts_;
  std::shared_ptr<StepWatcher> next_;
  PosesSent& packets_;
  std::optional<Clock::time_point> begin_;  ///< when the session's time was 0
  double first_ = 0.0;                      ///< time of the first frame [s]
  std::optional<double> sent_;              ///< time of the last packet, from the first frame on [s]
};

/// The subject's expressions without what they move.
Result<std::unique_ptr<SentFace>> sentFaceOf(const Subject& subject, std::span<const std::string> given) {
  if (!subject.file) return std::make_unique<SentFace>(Expressions(), std::vector<float>());
  LORICA_TRY(std::vector<float> chosen, chosenExpressions(subject.file->expressions, given, subject.name));
  Expressions expressions = subject.file->expressions;
  expressions.baseWeights.clear();
  for (Expression& expression : expressions.list) expression.morphs.clear();
  return std::make_unique<SentFace>(std::move(expressions), std::move(chosen));
}

}  // namespace

std::string inWords(const PosesSent& sent, const PoseOutputOptions& options) {
  std::string text;
  if (options.vmc) {
    text = fmt::format("{} and {} to {}", counted(sent.vmc, "pose"), counted(sent.contacts, "contact"),
                       textOf(*options.vmc));
  }
  const auto add = [&text](bool asked, int poses, std::string_view to) {
    if (asked) text += fmt::format("{}{} to {}", text.empty() ? "" : "; ", counted(poses, "pose"), to);
  };
  add(options.vrchat.has_value(), sent.vrchat, "VRChat");
  add(options.vmt.has_value(), sent.vmt, "Virtual Motion Tracker");
  return text;
}

Result<std::shared_ptr<StepWatcher>> makePoseOutput(const PoseOutputOptions& options, const Subject& subject,
                                                    std::span<const std::string> expressions,
                                                    std::shared_ptr<const LiveSources> live,
                                                    std::shared_ptr<StepWatcher> next, PosesSent& sent) {
  if (options.trackers.any() && !options.vrchat && !options.vmt) {
    return invalidArgument("--trackers: found neither --vrchat nor --vmt, which send them");
  }
  if (options.vmt && options.trackers == TrackerGroups().set(0)) {
    return invalidArgument("--trackers: found the head alone, which SteamVR has from the headset, expected others too");
  }
  if (!options.any()) return next;
  Result<BonePoseReader> made = BonePoseReader::create(subject.character->skeleton);
  if (!made) {
    const char* option = options.vmc ? "--vmc-out" : options.vrchat ? "--vrchat" : "--vmt";
    return Error{made.error().code, fmt::format("{}: {}{}", option, made.error().message, mapHint(*subject.character))};
  }
  LORICA_TRY(std::unique_ptr<SentFace> face, sentFaceOf(subject, expressions));
  std::optional<VmcReceiverAt> vmc;
  if (options.vmc) {
    LORICA_TRY(UdpSocket socket, prefixed("--vmc-out", UdpSocket::connect(*options.vmc)));
    vmc.emplace(VmcReceiverAt{std::move(socket), VmcWriter(options.bones.value_or(allVmcBones()))});
  }
  std::vector<TrackersAt> trackers;
  const TrackerGroups groups = options.trackers.none() ? TrackerGroups().set() : options.trackers;
  const auto sendTrackers = [&](const char* option, const std::optional<NetworkAddress>& to, TrackerReceiver receiver,
                                int& count) -> Result<void> {
    if (!to) return {};
    LORICA_TRY(UdpSocket socket, prefixed(option, UdpSocket::connect(*to)));
    trackers.push_back({std::move(socket), TrackerWriter(receiver, subject.character->height, groups), &count});
    return {};
  };
  LORICA_TRY_DO(sendTrackers("--vrchat", options.vrchat, TrackerReceiver::kVrchat, sent.vrchat));
  LORICA_TRY_DO(sendTrackers("--vmt", options.vmt, TrackerReceiver::kVmt, sent.vmt));
  return std::shared_ptr<StepWatcher>(std::make_shared<PoseOutput>(
      *std::move(made), std::move(face), std::move(vmc), std::move(trackers), std::move(live), std::move(next), sent));
}

}  // namespace lorica
