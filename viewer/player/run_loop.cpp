
#include "viewer/player/run_loop.h"
#include "geometry/counts.h"
#include "viewer/player/follow_camera.h"

#include <fmt/format.h>

#include <algorithm>

namespace lorica {
namespace {

constexpr int kMaxStepsAPicture = 6;
constexpr double kLongestPause = 0.25;  // longer gaps in a recording, or while the window is dragged, are skipped [s]
constexpr double kSeekSlice = 0.04;     // duration of seeking between pictures [s]
constexpr double kLongestRest = 0.1;    // warnings come and go [s]
constexpr double kWorking = 0.03;       // between looks at work in the background [s]
constexpr double kPolled = 0.004;       // between looks at a live source [s]
constexpr double kSureJoint = 0.5;      // confidence
constexpr double kAfterSeconds = 1.0 / 60.0;  // frames of a world that goes on after the end [s]

}  // namespace

RunLoop::RunLoop(Run& run, Shown& shown, Host& host)
    : run_(run),
      shown_(shown),
      host_(host),
      screen_(shown.screen),
      session_(run.session),
      hands_(run.restartable()),
      due_(now()) {
  if (screen_ == nullptr) return;
  screen_->setWearer({});  // what was known of the run before
  headset_.begin(run.tracked() ? run.name() : "", run.headset());
  if (!run.watched()) scenes_ = scenesNextTo(run.cast.request.scene);
  scene_.emplace(session_);
  levels_.emplace(session_.body().plan(), session_.character());
  avatarNames_ = avatarNames(session_);
  title_ = titleOf(session_, run.name(), run.live());
  const std::shared_ptr<const Avatar>& avatar = session_.character().avatar;
  if (avatar == nullptr) return;
  for (const Expression& expression : avatar->face.expressions.list) expressions_.push_back(expression.name);
  const std::vector<float>& given = avatar->face.chosen;
  const bool any = std::any_of(given.begin(), given.end(), [](float weight) { return weight != 0.0f; });
  if (any || run.streams().size() > 0) expression_ = kExpressionsAsGiven;
}

Result<RunEnd> RunLoop::run() {
  if (screen_ == nullptr) return runUnseen();
  while (screen_->open() && !closed_) {
    if (host_.cancelled()) return RunEnd::kInterrupted;
    LORICA_TRY_DO(answer(screen_->takeChanges()));
    followHeadsets();
    LORICA_TRY_DO(treat());
    if (shown_.next) return RunEnd::kExchanged;
    LORICA_TRY_DO(takeWorld());
    LORICA_TRY_DO(seek_ && !nextWorld_ ? runSeek() : advance());
    if (started_ && run_.enough()) return RunEnd::kOver;
    if (ended_ && !seek_) {
      if (run_.setting.atEnd == AtEnd::kReturn) return RunEnd::kOver;
      if (loops() && screen_->wantsStep()) {
        LORICA_TRY_DO(startOver());
        LORICA_TRY_DO(step());
      }
    }
    show();
    screen_->rest(restSeconds());
  }
  return RunEnd::kClosed;
}

/// Gives the wearer of a headset, who may be any of several people, the place where the depth camera sees them.
void RunLoop::followHeadsets() {
  for (const HeadsetPose& pose : screen_->headsets()) headset_.addHeadset(pose, now());
  const DepthSight* sight = run_.sight();
  std::span<const SkeletonFrame> people;
  if (sight != nullptr) people = sight->places.empty() ? std::span(&sight->joints, 1) : sight->places;
  for (std::size_t place = 0; place < people.size(); ++place) {
    const TrackedJoint& head = people[place][BodyJoint::kHead];
    if (head.confidence > kSureJoint) {
      headset_.addTracked(place, head.position + sight->stage, secondsOf(sight->arrived));
    }
  }
  const Vec3 origin = sight != nullptr ? sight->stage : Vec3(Vec3::Zero());
  if (const auto state = headset_.update(now(), origin)) screen_->setWearer(*state);
}

/// How long nothing is to be done unless the user asks for it [s].
double RunLoop::restSeconds() const {
  if (seek_ || screen_->choices().scrubbing) return 0.0;
  const bool background = nextWorld_ || levels_->asked() || (shown_.opener != nullptr && shown_.opener->loading());
  if (screen_->choices().paused || (ended_ && !goesOn())) return background ? kWorking : kLongestRest;
  if (run_.live()) return kPolled;
  return std::clamp(due_ - now(), 0.0, background ? kWorking : kLongestRest);
}

/// Without a screen: steps and pictures, as fast as they come.
Result<RunEnd> RunLoop::runUnseen() {
  const RunSetting& setting = run_.setting;
  std::optional<Task> task;
  if (!run_.live()) task.emplace(host_, setting.doing + " " + run_.name(), setting.unit);
  while (!ended_) {
    if (host_.cancelled()) return RunEnd::kInterrupted;
    LORICA_TRY_DO(step());
    const int frame = session_.frameCount();
    if (frame == shownFrame_) break;  // the sources are over
    shownFrame_ = frame;
    if (task) task->update(frame, setting.expected > 0 ? std::max(setting.expected, frame) : setting.frames);
    if (!shown_.picture) continue;
    LORICA_TRY(const bool more, shown_.picture());
    if (!more) break;
  }
  return RunEnd::kOver;
}

/// After the end. Sand and water would need seconds to settle again: there only the motion starts again.
Result<void> RunLoop::startOver() {
  hands_.forget();
  if (session_.world().particles() == nullptr) return restart();
  session_.world().stepAvatars({}, 0.0);  // the avatars come back without sweeping
  return restartIn(std::move(session_.world()));
}

Result<void> RunLoop::restartIn(World world) {
  LORICA_TRY(std::vector<std::unique_ptr<PoseSource>> sources, this->sources());
  hands_.rewind(session_);
  session_.restart(std::move(sources), std::move(world));
  ++changes_;
  LORICA_TRY_DO(run_.restarted(host_));
  warnings_.clear();
  focus_.reset();
  started_ = ended_ = false;
  frameBegin_ = 0.0;
  due_ = now();
  return {};
}

Result<void> RunLoop::beginSeek(double to) {
  // A held slider repeats its request, and the current frame may already be the requested one.
  if (seek_ && seek_->to == to) return {};
  if (started_ && to <= seconds() && (to > frameBegin_ || session_.frameCount() == 1)) return {};
  if (ended_ && to > seconds()) return {};
  if (!seek_) seek_ = Seek{};
  seek_->to = to;
  if (!started_ || to > seconds() || startsAgain()) return {};
  return restart();
}

Result<void> RunLoop::runSeek() {
  const double until = now() + kSeekSlice;
  while (now() < until && !ended_ && (!started_ || seconds() < seek_->to)) {
    LORICA_TRY_DO(step());
  }
  if (!ended_ && seconds() < seek_->to) {
    status_ = fmt::format("going to {:.1f} s: {:.1f} s", seek_->to, seconds());
    return {};
  }
  if (!seek_->done.empty()) screen_->notice(std::string(seek_->done));
  seek_.reset();
  due_ = now();
  describe();
  return {};
}

/// Runs the frames that are due. Drawing may take longer than a frame, so several may be due; their number is limited
/// to keep the window responsive.
Result<void> RunLoop::advance() {
  if (ended_) {
    goOn();
    return {};
  }
  for (int steps = 0; steps < kMaxStepsAPicture && !ended_; ++steps) {
    if (!run_.ready()) break;
    const bool live = run_.live();
    // Single steps are not timed.
    if (!live && !run_.setting.hurry && !screen_->choices().paused && now() < due_) break;
    if (!screen_->wantsStep()) {
      due_ = now();
      break;
    }
    const double before = started_ ? session_.time() : 0.0;
    const bool first = !started_;
    LORICA_TRY_DO(step());
    if (ended_) break;
    describe();
    addStageTimes(session_, run_.trackingSeconds(), *screen_);
    if (live) break;  // only the latest frame counts
    const double length = first ? 0.0 : std::min(session_.time() - before, kLongestPause);
    due_ += length / screen_->choices().speedFactor();
    // Catch up with late frames, but not after a long stop such as a pause or a dragged window.
    if (now() - due_ > kLongestPause) due_ = now();
  }
  return {};
}

/// The world after the end of the recording: the avatars stand, and what the user throws and drags still moves.
void RunLoop::goOn() {
  if (!goesOn()) return;
  hands_.goOnWithout();
  // Their parts no longer have the velocity of the last frame: it would strike in each step.
  standing_.resize(session_.avatars().size());
  std::vector<std::span<const LivePart>> standing;
  for (std::size_t a = 0; a < standing_.size(); ++a) {
    const std::span<const LivePart> parts = session_.avatars()[a].partsInWorld();
    standing_[a].assign(parts.begin(), parts.end());
    for (LivePart& part : standing_[a]) part.previousWorldFromPart = part.worldFromPart;
    standing.emplace_back(standing_[a]);
  }
  for (int steps = 0; steps < kMaxStepsAPicture && (screen_->choices().paused || now() >= due_); ++steps) {
    if (!screen_->wantsStep()) {
      due_ = now();
      break;
    }
    hands_.beforeStep(*screen_, session_);
    session_.world().stepAvatars(standing, kAfterSeconds);
    ++changes_;
    due_ += kAfterSeconds / screen_->choices().speedFactor();
    if (now() - due_ > kLongestPause) due_ = now();
  }
  describe();
}

Result<void> RunLoop::step() {
  hands_.beforeStep(*screen_, session_);
  const double before = seconds();
  const Result<bool> more = stepSession();
  if (closed_) {
    ended_ = true;
    return {};
  }
  if (!more) return more.error();
  if (!*more) {
    ended_ = true;
    describe();
    return {};
  }
  if (!started_) firstTime_ = session_.time();
  started_ = true;
  ++changes_;
  if (session_.frameCount() == 1) firstParts_ = partsOf(session_);
  frameBegin_ = before;
  if (scene_) scene_->follow(session_);
  focus_.update(session_);
  if (const std::optional<Aabb> avatars = aimed_ ? std::nullopt : focus_.bounds(session_); avatars && screen_) {
    screen_->setCamera(windowCamera(*avatars, focus_.facing(session_), session_.world()));
    aimed_ = true;
  }
  run_.stepped(host_);
  if (screen_ != nullptr) inset_ = run_.drawInset();
  const bool over = (run_.setting.frames > 0 && session_.frameCount() >= run_.setting.frames) ||
                    (run_.setting.seconds > 0.0 && seconds() >= run_.setting.seconds);
  if (over) ended_ = true;
  return {};
}

void RunLoop::show() {
  const double time = now();
  if (started_) raiseWarnings(session_, run_.trouble(), time, warnings_);
  warnings_.update(time);

  WindowValues values;
  listControls();
  values.controls = &controls_;
  values.name = title_;
  values.status = status_;
  values.seconds = seek_ ? std::min(seconds(), seek_->to) : seconds();
  values.duration = run_.duration();
  values.ended = ended_;
  values.warnings = warnings_.sentences();
  const auto outside = [](const SessionAvatar& avatar) { return avatar.present() && avatar.outsideKnownRange(); };
  values.outsideTraining = started_ && std::any_of(session_.avatars().begin(), session_.avatars().end(), outside);
  values.holds = hands_.holds();
  values.focus = focus_.position();
  if (started_) values.followed = focus_.bounds(session_);
  if (started_ && !session_.avatars().empty()) values.facing = focus_.facing(session_);
  values.avatar = focus_.avatar();
  if (shown_.opener != nullptr) shown_.opener->describe(values);
  describeNextWorld(values);
  values.changes = changes_;
  values.hits = run_.hits.scores();
  values.smoothingDelay = started_ ? session_.source().smoothingDelay().value_or(-1.0) : -1.0;
  if (run_.recorder) values.recording = run_.setting.record;
  Scene scene;
  if (started_) {
    scene = scene_->of(session_, screen_->choices().show, screen_->camera().eye);
    scene.inset = inset_;
  }
  screen_->show(scene, values);
}

Result<RunEnd> play(Run& run, Shown& shown, Host& host) {
  RunLoop loop(run, shown, host);
  if (shown.screen != nullptr) loop.recallSettings();
  Result<RunEnd> end = loop.run();
  if (shown.screen != nullptr && shown.screen->personal()) loop.keepSettings();
  // What was recorded is kept despite an error or an early end.
  const bool early = !end || *end == RunEnd::kInterrupted || *end == RunEnd::kExchanged;
  if (early && run.recorder) (void)run.recorder->finish();
  return end;
}

}  // namespace lorica
