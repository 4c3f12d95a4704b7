#include "viewer/player/run.h"

#include "geometry/clock.h"
#include "geometry/errors.h"
#include "session/prepare/scenes.h"
#include "viewer/player/snapshots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lorica {
namespace {

constexpr double kSameTime = 1e-6;           // [s]
constexpr double kWithoutPose = 1.0 / 30.0;  // steps of an avatar whose headset is not worn [s]
constexpr double kHeadsetGone = 2.0;         // without a pose [s]

constexpr double kNearest = 500.0, kFar = 5000.0;  // depths of the lightest and the darkest grey [mm]
constexpr int kDot = 3;                            // radius [pixels of the picture]

using Color = std::array<std::uint8_t, 3>;
constexpr Color kSeen = {60, 220, 90}, kGuessed = {250, 160, 40};

void paint(Image& picture, int x, int y, const Color& color) {
  if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return;
  const std::size_t at = 4 * (static_cast<std::size_t>(y) * picture.width + x);
  std::copy(color.begin(), color.end(), picture.rgba.begin() + at);
}

std::uint8_t shade(std::uint16_t depthMm) {
  if (depthMm == 0) return 0;
  const double nearness = (kFar - depthMm) / (kFar - kNearest);
  return std::lround(40.0 + 190.0 * std::clamp(nearness, 0.0, 1.0));
}

}  // namespace

Run::Run(Cast given, RunSetting asked, Session started)
    : cast(std::move(given)),
      setting(std::move(asked)),
      session(std::move(started)),
      hits(cast.targets),
      targets_(cast.targets) {}

Result<std::unique_ptr<Run>> Run::make(Cast cast, RunSetting setting, Host& host) {
  LORICA_TRY(std::shared_ptr<SessionRecorder> recorder, startRecorder(setting.record, cast, host));
  Result<Session> session = startSession(cast, recorder.get());
  if (!session) {
    if (recorder) (void)recorder->finish();  // removes the file
    return session.error();
  }
  std::unique_ptr<Run> run(new Run(std::move(cast), std::move(setting), std::move(*session)));
  run->recorder = std::move(recorder);
  return run;
}

Result<std::unique_ptr<Run>> Run::start(Cast cast, RunSetting setting, Host& host) {
  const auto tracked = [](const PreparedAvatar& avatar) { return !avatar.motion->joints.empty(); };
  const bool anyTracked = std::any_of(cast.avatars.begin(), cast.avatars.end(), tracked);
  LORICA_TRY(std::unique_ptr<Run> run, make(std::move(cast), std::move(setting), host));
  run->treatment = treatmentControl(run->cast.request.performing, anyTracked);
  LORICA_TRY_DO(run->watch(host));
  return run;
}

Result<std::unique_ptr<Run>> Run::start(LiveCast live, RunSetting setting, Host& host) {
  setting.atEnd = AtEnd::kReturn;
  LORICA_TRY(std::unique_ptr<Run> run, make(std::move(live.cast), std::move(setting), host));
  run->live_ = std::move(live.sources);
  run->treatment = treatmentControl(run->cast.request.performing, run->live_->vmc.empty());
  LORICA_TRY_DO(run->watch(host));
  return run;
}

Result<std::unique_ptr<Run>> Run::start(RecordedCast recorded, RunSetting setting, Host& host) {
  setting.atEnd = AtEnd::kHold;
  LORICA_TRY(std::unique_ptr<Run> run, make(std::move(recorded.cast), std::move(setting), host));
  run->recorded_ = std::make_unique<RecordedCast>(std::move(recorded));
  LORICA_TRY_DO(run->watch(host));
  return run;
}

/// What watches the session's steps: recorder or comparison, then what sends poses, then events.
Result<void> Run::watch(Host& host) {
  unrecorded_ = treatment;
  if (setting.written()) treatment.fix("what is written or sent is as the command says");
  if (recorded_) comparison = std::make_shared<SessionReplay>(recorded_->session);
  std::shared_ptr<StepWatcher> next = recorder;
  if (comparison) next = comparison;
  LORICA_TRY(
      const std::shared_ptr<StepWatcher> sender,
      makePoseOutput(setting.out, cast.avatars.front().subject, cast.request.reading.expressions, live_, next, sent));
  LORICA_TRY_DO(finish());
  LORICA_TRY(events_, makeEventsOutput(setting.events, sender, host));
  session.watch(events_ ? events_ : sender);
  return {};
}

const std::vector<VmcInput>& Run::streams() const {
  static const std::vector<VmcInput> none;
  return live_ ? live_->vmc : none;
}

bool Run::ready() const {
  if (tracked()) return live_->tracked->ready();
  if (live_ && live_->threePoint()) {
    const std::optional<HeadAndHands> newest = headset()->newest();
    return newest &&
           (session.frameCount() == 0 || newest->time > session.time() || now() > session.time() + kWithoutPose);
  }
  return streams().empty() || streams().front().ready(session);
}

std::string Run::trouble() const {
  if (tracked()) return log.state();
  if (live_ && live_->threePoint()) {
    const std::optional<HeadAndHands> newest = headset()->newest();
    return newest && now() - newest->time < kHeadsetGone ? "" : "the headset is not worn: its avatar stays as it is";
  }
  return streams().empty() ? "" : streams().front().state();
}

std::optional<double> Run::trackingSeconds() const {
  return tracked() ? std::optional(live_->tracked->sight().trackSeconds) : std::nullopt;
}

void Run::stepped(Host& host) {
  if (++frames_ == 1) firstTime_ = session.time();
  now_ = session.time() - firstTime_;
  if (tracked()) log.add(*live_->tracked, now_, host);
  if (live_) {
    for (VmcInput& sender : live_->vmc) sender.add(session, host);
  }
  statistics.add(session, setting.selfContacts);
  hits.add(session);
  if (frames_ == 1 && first) first(*this, host);
}

const Image* Run::drawInset() {
  if (tracked()) {
    drawDepthPicture(live_->tracked->source().camera(), live_->tracked->sight(), inset);
    return &inset;
  }
  const std::optional<DepthSight> sight = recordedSight();
  if (!sight) return nullptr;
  drawDepthPicture(depth_->camera(), *sight, inset);
  return &inset;
}

std::optional<DepthSight> Run::recordedSight() {
  if (cast.avatars.empty() || !cast.avatars.front().motion || !cast.avatars.front().motion->depth) return std::nullopt;
  const Motion& motion = *cast.avatars.front().motion;
  if (depth_ == nullptr) {
    Result<std::unique_ptr<DepthRecording>> opened = openDepthRecording(motion.depth->file, motion.depth->lens);
    if (!opened) return std::nullopt;  // it is gone meanwhile
    depth_ = std::move(*opened);
  }
  const auto later =
      std::ranges::upper_bound(motion.joints, motion.firstTime() + now_ + kSameTime, {}, &SkeletonFrame::time);
  const std::size_t frame = std::max<std::ptrdiff_t>(later - motion.joints.begin(), 1) - 1;
  depth_->seek(int(frame));
  DepthSight sight;
  sight.joints = motion.joints[frame];
  sight.cameraFromWorld = motion.depth->cameraFromWorld[frame];
  const Result<DepthRead> read = depth_->next(sight.image);
  if (!read || *read != DepthRead::kFrame) return std::nullopt;
  return sight;
}

Result<void> Run::restarted(Host& host) {
  before_ += now_;
  now_ = 0.0;
  frames_ = 0;
  hits = TargetHits(targets_);
  if (setting.sumUp) {
    statistics.restart();
  } else {
    statistics = RunStatistics();
  }
  return recorded_ ? watch(host) : Result<void>();
}

Result<int> Run::stopRecording() {
  LORICA_TRY(const int steps, std::exchange(recorder, nullptr)->finish());
  setting.record.clear();
  if (!live()) setting.atEnd = AtEnd::kChoice;
  treatment = unrecorded_;
  return steps;
}

void Run::sceneChosen(const std::string& scene, Host& host) {
  cast.request.scene = scene;
  targets_ = targetsOf(scene, host);
  if (live()) hits = TargetHits(targets_);
}

void prepareScreen(const Run& run, Screen& screen, const std::optional<Background>& background) {
  const Character& character = run.session.character();
  screen.setTitle(run.name().empty() ? "Lorica" : "Lorica: " + run.name());
  SceneOptions& show = screen.choices().show;
  show = usualView(character);
  if (run.setting.allLayers) show.hulls = true;
  setBackground(background, show);
}

void drawDepthPicture(const DepthCamera& camera, const DepthSight& sight, Image& picture) {
  const DepthFrame& depth = sight.image;
  if (depth.depthMm.empty()) return;
  picture.width = camera.width / 2;
  picture.height = camera.height / 2;
  picture.rgba.assign(4 * static_cast<std::size_t>(picture.width) * picture.height, 255);
  for (int y = 0; y < picture.height; ++y) {
    const std::uint16_t* row = depth.depthMm.data() + 2 * static_cast<std::ptrdiff_t>(y) * camera.width;
    for (int x = 0; x < picture.width; ++x) {
      const std::uint8_t value = shade(row[2 * x]);
      paint(picture, x, y, {value, value, value});
    }
  }
  for (const TrackedJoint& joint : sight.joints.joints) {
    if (joint.confidence <= 0.0) continue;
    const Vec3 position = sight.cameraFromWorld * joint.position;
    if (position.z() > -0.1) continue;
    const Eigen::Vector2d middle = 0.5 * camera.imagePointOf(position);
    const int cx = std::lround(middle.x()), cy = std::lround(middle.y());
    for (int dy = -kDot; dy <= kDot; ++dy) {
      for (int dx = -kDot; dx <= kDot; ++dx) {
        if (dx * dx + dy * dy <= kDot * kDot)
          paint(picture, cx + dx, cy + dy, joint.confidence < 0.75 ? kGuessed : kSeen);
      }
    }
  }
}

}  // namespace lorica
