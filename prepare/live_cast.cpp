#include "prepare/live_cast.h"

#include "geometry/errors.h"
#include "geometry/text.h"
#include "prepare/cast.h"
#include "prepare/scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lorica {
namespace {

constexpr double kBeforeCamera = 0.9;  // of the work of opening a live session

/// Joints of a source that several sessions follow, one after the other.
class SharedJoints final : public SkeletonSource {
 public:
  explicit SharedJoints(std::shared_ptr<SkeletonSource> source) : source_(std::move(source)) {}
  Result<std::optional<SkeletonFrame>> next() override { return source_->next(); }

 private:
  std::shared_ptr<SkeletonSource> source_;
};

/// The poses of a character that follows the performer.
Result<std::unique_ptr<PoseSource>> sourceOf(const Character& character, Performer& performer, std::size_t index,
                                             const SourceTreatment& treatment) {
  if (performer.vmc.empty()) {
    return makeTreatedSource(character, std::make_unique<SharedJoints>(performer.joints[index]), treatment);
  }
  LORICA_TRY(std::unique_ptr<PoseSource> sent,
             performer.vmc[index].makeSource(character, treatment.joints.mirror, index == 0));
  return makeTreatedSource(std::move(sent), treatment);
}

}  // namespace

std::vector<VmcInputOptions> sendersOf(const LiveOptions& options) {
  std::vector<VmcInputOptions> senders;
  if (options.vmc.listenAt.empty()) return senders;
  for (const std::string& address : namesIn(options.vmc.listenAt)) {
    senders.push_back(options.vmc);
    senders.back().listenAt = address;
  }
  return senders;
}

std::size_t avatarsOf(const LiveOptions& options) {
  const std::size_t senders = sendersOf(options).size();
  return senders > 0 ? senders : static_cast<std::size_t>(options.people);
}

Result<void> checkPeople(const LiveOptions& options) {
  for (const VmcInputOptions& sender : sendersOf(options)) {
    LORICA_TRY_DO(checkVmcInput(sender));
  }
  if (options.vmc.listenAt.empty()) {
    LORICA_TRY_DO(checkVmcInput(options.vmc));
  }
  if (avatarsOf(options) <= kMaxPeople) return {};
  return invalidArgument("--people, --vmc: found {}, expected at most {}", avatarsOf(options), kMaxPeople);
}

Result<World> openSceneForPeople(const std::string& scene) {
  LORICA_TRY(OpenedScene opened, openStage(scene));
  if (!opened.stage.empty()) {
    warn(fmt::format("{}: its {} stay away, because avatars follow people here; `lorica play --scene {}` shows them",
                     scene, counted(std::ssize(opened.stage), "avatar"), scene));
  }
  return std::move(opened.world);
}

Result<Performer> openPerformer(const LiveOptions& options) {
  Performer performer{{}, nullptr, {}, ""};
  for (const VmcInputOptions& sender : sendersOf(options)) {
    LORICA_TRY(VmcInput vmc, VmcInput::open(sender));
    performer.name += (performer.vmc.empty() ? "" : " and ") + vmc.name();
    performer.vmc.push_back(std::move(vmc));
  }
  if (!performer.vmc.empty()) return performer;
  if (!options.nite.empty()) {
    LORICA_TRY(std::unique_ptr<SkeletonSource> source, openNite(options.depth, options.nite));
    performer.joints.push_back(std::move(source));
    performer.name = "NiTE 2";
    return performer;
  }
  LORICA_TRY(std::unique_ptr<DepthSource> depth, openDepth(options.depth));
  TrackerSettings settings;
  settings.maxPeople = std::max(settings.maxPeople, options.people);
  LORICA_TRY(Tracker tracker, Tracker::create(depth->camera(), settings));
  auto joints = std::make_unique<LiveJoints>(
      options.people > 1 ? DepthJoints(std::move(depth), std::move(tracker), PeoplePlaces(options.people))
                         : DepthJoints(std::move(depth), std::move(tracker), options.person));
  performer.tracked = joints.get();
  performer.name = joints->source().name();
  performer.joints.push_back(std::move(joints));
  for (int place = 1; place < options.people; ++place) {
    performer.joints.push_back(makePlaceSource(*performer.tracked, place));
  }
  return performer;
}

Result<std::vector<Follower>> readFollowers(const LiveOptions& options, bool drawn, int threads) {
  const std::vector<std::string> names = namesIn(options.character);
  const std::size_t people = avatarsOf(options);
  if (names.size() > 1 && names.size() != people) {
    return invalidArgument(
        "--character: found {} characters for {}, expected one for all or one for each; --people says how many there "
        "are",
        names.size(), people == 1 ? "1 person" : fmt::format("{} people", people));
  }
  CharacterOptions reading = options.reading;
  reading.drawn = drawn;
  if (options.vmc.listenAt.empty()) reading.suits = followsPerson;
  std::vector<Follower> followers;
  for (std::size_t i = 0; i < people; ++i) {
    const double count = people / kBeforeCamera, at = i;
    const WorkMonitor::Stage stage(at / count, (at + 1.0) / count);
    const std::string& name = names[names.size() == 1 ? 0 : i];
    LORICA_TRY(Subject subject, readCharacter(name, reading));
    LORICA_TRY_DO(checkCover(options.body.cover, *subject.character));
    LORICA_TRY(DecompositionFile body, chooseBody(options.body, subject, threads));
    std::optional<SpringChoice> springs = chooseSprings(subject, options.springs);
    followers.push_back({name, std::move(subject), std::move(body), std::move(springs)});
  }
  return followers;
}

Result<std::shared_ptr<SessionRecorder>> startRecorder(const LiveOptions& options, const Performer& performer,
                                                       std::span<const Follower> followers, const World& world) {
  std::vector<RecordedAvatar> avatars;
  const bool sent = !performer.vmc.empty();
  for (const Follower& follower : followers) {
    RecordedAs as{performer.name,     sent,         follower.name,   options.reading,
                  options.performing, options.body, follower.springs};
    as.stream = sent;
    avatars.push_back({std::move(as), follower.character(), follower.body});
  }
  return startRecorder(options.record, avatars, options.scene, world);
}

Result<std::vector<std::unique_ptr<PoseSource>>> sourcesOf(const LiveOptions& options, const Performer& performer,
                                                           std::span<const Follower> followers,
                                                           const WindowTreatment& treatment) {
  const MotionOptions performing = treated(options.performing, treatment);
  std::vector<std::unique_ptr<PoseSource>> sources;
  for (std::size_t i = 0; i < followers.size(); ++i) {
    LORICA_TRY(std::unique_ptr<PoseSource> source,
               makeTreatedSource(followers[i].character(), std::make_unique<SharedJoints>(performer.joints[i]),
                                 {nullptr, performing.faults(), performing.joints()}));
    sources.push_back(std::move(source));
  }
  return sources;
}

Result<Session> startSession(const LiveOptions& options, Performer& performer, std::span<const Follower> followers,
                             const std::shared_ptr<SessionRecorder>& recorder, World world) {
  Session session(std::move(world));
  for (std::size_t i = 0; i < followers.size(); ++i) {
    const Follower& follower = followers[i];
    const SourceTreatment treatment{recorder ? recorder->log(i) : nullptr, options.performing.faults(),
                                    options.performing.joints()};
    LORICA_TRY(std::unique_ptr<PoseSource> source, sourceOf(follower.character(), performer, i, treatment));
    const AvatarSetting setting{std::nullopt, follower.springs};
    LORICA_TRY_DO(addAvatar(session, follower.character(), follower.body, std::move(source), setting));
  }
  return session;
}

}  // namespace lorica
