#include "session/prepare/live_cast.h"

#include "capture/headset/three_point_body.h"
#include "collision/hulls/cover_choice.h"
#include "geometry/clock.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/interrupt.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"
#include "session/prepare/scenes.h"
#include "session/prepare/stream_motion.h"
#include "session/stream_pose_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lorica {
namespace {

constexpr double kSilentSeconds = 0.5;
constexpr double kLongestWait = 1.0 / 30.0;
constexpr int kLongestDelayMs = 1000;

constexpr double kBeforeCamera = 0.9;  // of the work of preparing a live cast

/// Joints of a source that several sessions follow, one after the other; see LiveSources::withHead(), which outlive it.
class SharedJoints final : public SkeletonSource {
 public:
  SharedJoints(const LiveSources& sources, std::size_t index) : sources_(sources), source_(sources.joints[index]) {}

  Result<std::optional<SkeletonFrame>> next() override {
    Result<std::optional<SkeletonFrame>> got = source_->next();
    if (got && *got) **got = sources_.withHead(**got);
    return got;
  }

 private:
  const LiveSources& sources_;
  std::shared_ptr<SkeletonSource> source_;
};

/// The options of each program that sends; empty without --vmc.
std::vector<VmcInputOptions> sendersOf(const VmcInputOptions& vmc) {
  std::vector<VmcInputOptions> senders;
  if (vmc.listenAt.empty()) return senders;
  for (const std::string& address : namesIn(vmc.listenAt)) {
    senders.push_back(vmc);
    senders.back().listenAt = address;
  }
  return senders;
}

Result<World> openSceneForPeople(const std::string& scene, Host& host) {
  LORICA_TRY(OpenedScene opened, openStage(scene, host));
  if (!opened.stage.empty()) {
    host.warn(
        fmt::format("{}: its {} stay away, because avatars follow people here; `lorica play --scene {}` shows them",
                    scene, counted(countOf(opened.stage), "avatar"), scene));
  }
  return std::move(opened.world);
}

Result<std::shared_ptr<LiveSources>> openStreams(const LiveRequest& live, const Host& host) {
  auto sources = std::make_shared<LiveSources>();
  for (const VmcInputOptions& sender : sendersOf(live.vmc)) {
    LORICA_TRY(VmcInput vmc, VmcInput::open(sender, host));
    sources->name += (sources->vmc.empty() ? "" : " and ") + vmc.name();
    sources->vmc.push_back(std::move(vmc));
  }
  return sources;
}

Result<std::shared_ptr<LiveSources>> openHeadset() {
  auto sources = std::make_shared<LiveSources>();
  sources->headset = std::make_shared<WornHeadset>();
  sources->joints.push_back(makeThreePointJoints(sources->headset));
  sources->name = "head and hands";
  return sources;
}

Result<std::shared_ptr<LiveSources>> openPeople(const LiveRequest& live) {
  auto sources = std::make_shared<LiveSources>();
  if (!live.nite.empty()) {
    LORICA_TRY(std::unique_ptr<SkeletonSource> source, openNite(live.depth, live.nite));
    sources->joints.push_back(std::move(source));
    sources->name = "NiTE 2";
    return sources;
  }
  Result<std::unique_ptr<DepthSource>> opened = openDepth(live.depth);
  if (!opened && live.headset && !live.depth.asked()) return openHeadset();
  if (!opened) return opened.error();
  std::unique_ptr<DepthSource> depth = std::move(*opened);
  sources->sent = dynamic_cast<const DepthStream*>(depth.get());
  TrackerSettings settings;
  settings.maxPeople = std::max(settings.maxPeople, live.people);
  settings.lowerBody = live.lowerBody;
  LORICA_TRY(Tracker tracker, Tracker::create(depth->camera(), settings));
  DepthJoints tracking = live.people > 1 ? DepthJoints(std::move(depth), std::move(tracker), PeoplePlaces(live.people))
                                         : DepthJoints(std::move(depth), std::move(tracker), live.person);
  sources->headset = std::make_shared<WornHeadset>();
  tracking.wear(sources->headset);
  auto joints = std::make_unique<LiveJoints>(std::move(tracking));
  sources->tracked = joints.get();
  sources->name = joints->source().name();
  sources->joints.push_back(std::move(joints));
  for (int place = 1; place < live.people; ++place) {
    sources->joints.push_back(makePlaceSource(*sources->tracked, place));
  }
  return sources;
}

Result<std::vector<PreparedAvatar>> readFollowers(const CastRequest& request, const LiveRequest& live, Host& host) {
  const std::vector<std::string> names = namesIn(request.character.empty() ? "mannequin" : request.character);
  const std::size_t people = live.avatars();
  if (names.size() > 1 && names.size() != people) {
    return invalidArgument(
        "--character: found {} characters for {}, expected one for all or one for each; --people says how many there "
        "are",
        names.size(), counted(people, "person", "people"));
  }
  const bool sent = !live.vmc.listenAt.empty();
  CharacterOptions reading = request.reading;
  if (!sent) reading.suits = followsPerson;
  std::vector<PreparedAvatar> avatars;
  for (std::size_t i = 0; i < people; ++i) {
    const double count = double(people) / kBeforeCamera;
    const Stage stage(host, double(i) / count, double(i + 1) / count);
    PreparedAvatar avatar;
    avatar.poses = avatar.stream = sent;
    avatar.setting.character = names[names.size() == 1 ? 0 : i];
    LORICA_TRY(avatar.subject, readCharacter(avatar.setting.character, reading, host));
    LORICA_TRY_DO(checkCover(request.body.cover, avatar.character()));
    LORICA_TRY(avatar.body, chooseBody(request.body, avatar.subject, host));
    avatar.springs = chooseSprings(avatar.subject, request.springs);
    avatars.push_back(std::move(avatar));
  }
  return avatars;
}

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
  const bool receives = last && view_->now() - last->time < kSilentSeconds;
  if (receives != receives_) {
    const std::string title = view_->title();
    host.tell(receives ? fmt::format("A program is sending{}.", title.empty() ? "" : ": " + printable(title))
                       : std::string("No program is sending any more."));
  }
  receives_ = receives;
}

std::string VmcInput::state() const {
  return receives_ ? "" : "no program is sending";
}

std::size_t LiveRequest::avatars() const {
  const std::size_t senders = sendersOf(vmc).size();
  return senders > 0 ? senders : people;
}

SkeletonFrame LiveSources::withHead(SkeletonFrame person) const {
  if (headset == nullptr || threePoint() || !tracked->sight().worn) return person;
  const DepthSight& sight = tracked->sight();
  WornHead then = *sight.worn;
  if (std::optional<WornHead> latest = headset->latest(now())) {
    then.position -= sight.stage;
    latest->position -= sight.stage;
    moveWithHead(then, *latest, person);
  }
  return person;
}

Result<std::unique_ptr<PoseSource>> LiveSources::open(const PreparedAvatar& avatar, std::size_t index,
                                                      const MotionOptions& performing, std::shared_ptr<SourceLog> log) {
  const SourceTreatment treatment{std::move(log), performing.inject, performing.joints()};
  if (vmc.empty()) {
    return makeTreatedSource(avatar.character(), std::make_unique<SharedJoints>(*this, index), treatment);
  }
  LORICA_TRY(std::unique_ptr<PoseSource> source,
             vmc[index].makeSource(avatar.character(), treatment.joints.mirror, index == 0));
  return makeTreatedSource(std::move(source), treatment);
}

Result<void> checkLive(const LiveRequest& live, const Host& host) {
  for (const VmcInputOptions& sender : sendersOf(live.vmc)) LORICA_TRY_DO(checkVmcInput(sender, host));
  if (live.vmc.listenAt.empty()) LORICA_TRY_DO(checkVmcInput(live.vmc, host));
  LORICA_TRY_DO(checkDepth(live.depth));
  if (live.threePoint && (live.avatars() > 1 || live.person > 0 || !live.vmc.listenAt.empty())) {
    return invalidArgument("--three-point follows the wearer of a headset: --people, --person and --vmc do not apply");
  }
  if (live.avatars() <= kMaxPeople) return {};
  return invalidArgument("--people, --vmc: found {}, expected at most {}", live.avatars(), kMaxPeople);
}

Result<LiveCast> prepareLiveCast(const CastRequest& request, const LiveRequest& live, Host& host,
                                 std::shared_ptr<LiveSources> sources) {
  LORICA_TRY(World world, openSceneForPeople(request.scene, host));
  LORICA_TRY(std::vector<PreparedAvatar> avatars, readFollowers(request, live, host));
  // The source is opened last, because it runs while the rest is prepared. A driver may take as long as it likes.
  if (sources == nullptr) {
    LORICA_TRY(sources, !live.vmc.listenAt.empty() ? openStreams(live, host)
                        : live.threePoint          ? openHeadset()
                                                   : openWaiting<std::shared_ptr<LiveSources>>(
                                                live.depth, host, [live] { return openPeople(live); }));
  }
  if (sources->threePoint() && !live.threePoint) {
    host.tell("No depth camera was found: the avatar follows the headset and its controllers.");
  }
  for (PreparedAvatar& avatar : avatars) avatar.source = sources->name;
  Cast cast{request, std::move(world), targetsOf(request.scene, host), std::move(avatars), sources, sources->name};
  return LiveCast{std::move(cast), std::move(sources)};
}

}  // namespace lorica
