#include "apps/window_loop.h"

#include "apps/avatar_focus.h"
#include "apps/framing.h"
#include "apps/interrupt.h"
#include "apps/report.h"
#include "apps/scene_list.h"
#include "apps/scenes.h"
#include "apps/snapshots.h"
#include "apps/window_hands.h"
#include "apps/window_texts.h"
#include "apps/window_warnings.h"
#include "session/prepare/detail_levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

namespace lorica {
namespace {

constexpr int kMaxStepsAPicture = 6;
constexpr double kLongestPause = 0.25;  // longer gaps in a recording, or while the window is dragged, are skipped [s]
constexpr double kSeekSlice = 0.04;     // duration of seeking between pictures [s]
constexpr double kSoon = 0.25;          // longer seeks are reported [s]
constexpr double kAfterSeconds = 1.0 / 60.0;  // frames of a world that goes on after the end [s]

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

class WindowLoop {
 public:
  WindowLoop(Window& window, WindowSubject& subject, const PlaybackOptions& options)
      : window_(window),
        subject_(subject),
        session_(subject.session),
        options_(options),
        scenes_(subject.worldAgain ? SceneList{{}, {}} : scenesBeside(subject.scene)),
        scene_(session_),
        levels_(session_.body().plan(), session_.character()),
        hands_(subject.sourcesAgain != nullptr),
        avatarNames_(avatarNames(session_)),
        due_(now()) {
    const std::shared_ptr<const Avatar>& avatar = session_.character().avatar;
    if (avatar == nullptr) return;
    for (const Expression& expression : avatar->face.expressions.list) expressions_.push_back(expression.name);
  }

  Result<WindowEnd> run();

 private:
  /// A seek: the recording runs to a time without pictures.
  struct Seek {
    double to = 0.0;     // [s]
    double begun = 0.0;  // [s]
    int frames = 0;
    bool again = false;  // from the start
  };

  [[nodiscard]] bool onlyWatched() const { return subject_.worldAgain != nullptr; }
  [[nodiscard]] double seconds() const { return started_ ? session_.time() - firstTime_ : 0.0; }
  Result<void> answer(WindowRequests requests);
  [[nodiscard]] std::string_view whyNoThrow() const;
  [[nodiscard]] std::string_view whyNoUndo() const;
  [[nodiscard]] std::string_view whyNoLoop() const;
  [[nodiscard]] Result<World> worldAgain() const;
  Result<void> beginSeek(double to);
  Result<void> runSeek();
  Result<void> advance();
  Result<void> step();
  void goOn();
  void answerAboutAvatars(const WindowRequests& requests);
  Result<void> undo();
  [[nodiscard]] bool mayLoop() const { return subject_.atEnd != WindowSubject::AtEnd::kHold && subject_.sourcesAgain; }
  [[nodiscard]] bool loops() const;
  [[nodiscard]] bool goesOn() const { return ended_ && subject_.atEnd == WindowSubject::AtEnd::kChoice; }
  Result<void> startOver();
  Result<void> restart();
  Result<void> restartIn(World world);
  Result<void> changeScene(int scene);
  void saySettling();
  void describe() { status_ = statusOf(session_, ended_); }
  void show();

  Window& window_;
  WindowSubject& subject_;
  Session& session_;
  const PlaybackOptions& options_;
  SceneList scenes_;
  SessionScene scene_;
  DetailLevels levels_;
  WindowHands hands_;
  WarningBoard warnings_;
  AvatarFocus focus_;
  std::vector<std::string> avatarNames_;
  std::optional<Seek> seek_;
  double due_;  // of the next frame [s]
  double firstTime_ = 0.0;
  double frameBegin_ = 0.0;  // time of the previous frame, since the first [s]
  bool started_ = false, ended_ = false;
  std::string status_;
  std::vector<std::string> expressions_;  // of the avatar's face
  int expression_ = -1;                   // chosen in the window
};

// If there are particles, the first step takes seconds because they settle: announce it in a picture first.
void WindowLoop::saySettling() {
  const Particles* particles = session_.world().particles();
  if (particles == nullptr || particles->settings().settleSeconds <= 0.0) return;
  window_.notice("waiting for sand or water to settle");
  for (int picture = 0; picture < 2; ++picture) show();
}

Result<WindowEnd> WindowLoop::run() {
  window_.setCamera(framing(window_.camera(), session_.world()));
  saySettling();
  while (window_.open()) {
    if (interrupted()) return WindowEnd::kInterrupted;
    if (Result<void> done = answer(window_.takeRequests()); !done) return done.error();
    if (Result<void> done = seek_ ? runSeek() : advance(); !done) return done.error();
    if (started_ && subject_.enough && subject_.enough()) return WindowEnd::kOver;
    if (ended_ && !seek_) {
      if (subject_.atEnd == WindowSubject::AtEnd::kReturn) return WindowEnd::kOver;
      if (loops()) {
        if (Result<void> done = startOver(); !done) return done.error();
      }
    }
    show();
    // Limits the frame rate without vertical synchronisation.
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return WindowEnd::kClosed;
}

Result<void> WindowLoop::answer(WindowRequests requests) {
  if (const std::string_view why = whyNoThrow(); !why.empty()) {
    if (requests.throwBall) window_.notice(std::string(why));
    requests.throwBall = false;
    requests.pressed.reset();
  }
  answerAboutAvatars(requests);
  if (requests.undo) return undo();
  if (requests.scene && *requests.scene != scenes_.present) {
    if (Result<void> done = changeScene(*requests.scene); !done) return done;
  }
  hands_.take(requests, window_, session_);
  if (requests.parts && *requests.parts != levels_.asked().value_or(static_cast<int>(session_.body().parts().size()))) {
    levels_.ask(*requests.parts);
  }
  if (const std::shared_ptr<const BodyPlan> plan = levels_.take(); plan != nullptr && plan != session_.body().plan()) {
    session_.setBody(plan);
    scene_ = SessionScene(session_);
    scene_.chooseExpression(expression_);
    describe();
  }
  if (requests.nextExpression) requests.expression = expression_ + 1;
  if (requests.expression && !expressions_.empty()) {
    expression_ = *requests.expression < static_cast<int>(expressions_.size()) ? *requests.expression : -1;
    scene_.chooseExpression(expression_);
  }
  if (requests.seekTo && subject_.sourcesAgain) return beginSeek(*requests.seekTo);
  return {};
}

std::string_view WindowLoop::whyNoThrow() const {
  if (onlyWatched()) return "a recorded session cannot be changed";
  if (ended_ && !goesOn()) return "end of recording; press Home to restart";
  return {};
}

std::string_view WindowLoop::whyNoUndo() const {
  if (onlyWatched()) return "a recorded session cannot be changed";
  if (!subject_.sourcesAgain) return "what happened live cannot be undone";
  if (!hands_.canUndo()) return "nothing was thrown or dragged";
  return {};
}

std::string_view WindowLoop::whyNoLoop() const {
  return mayLoop() ? "" : onlyWatched() ? "a recorded session is run once" : "what is written is run once";
}

bool WindowLoop::loops() const {
  if (!mayLoop()) return false;
  return subject_.atEnd == WindowSubject::AtEnd::kRepeat || window_.choices().loop;
}

void WindowLoop::answerAboutAvatars(const WindowRequests& requests) {
  if (requests.avatar) focus_.choose(*requests.avatar);
  if (!requests.clicked || avatarNames_.size() < 2) return;
  const int clicked = avatarAt(session_, *requests.clicked);
  focus_.choose(clicked);
  window_.notice(clicked < 0 ? "following all avatars" : "following avatar " + avatarNames_[clicked]);
}

/// Runs again to the present time without the last action.
Result<void> WindowLoop::undo() {
  if (const std::string_view why = whyNoUndo(); !why.empty()) {
    window_.notice(std::string(why));
    return {};
  }
  hands_.undo();
  const double present = seconds();
  if (!seek_) seek_ = Seek{present, now(), 0, true};
  return restart();
}

Result<void> WindowLoop::changeScene(int scene) {
  Result<World> world = openScene(scenes_.arguments[scene]);
  if (!world) {
    window_.notice(world.error().message);
    return {};
  }
  scenes_.present = scene;
  if (subject_.sceneChosen) subject_.sceneChosen(scenes_.arguments[scene]);
  hands_.forget();
  if (subject_.sourcesAgain) return restart();
  session_.setWorld(std::move(*world));
  saySettling();
  return {};
}

/// The world of the session, or of the scene chosen last.
Result<World> WindowLoop::worldAgain() const {
  if (onlyWatched()) return subject_.worldAgain();
  return openScene(scenes_.arguments[scenes_.present]);
}

/// After the end. Sand and water would need seconds to settle again: there only the motion starts again.
Result<void> WindowLoop::startOver() {
  hands_.forget();
  if (session_.world().particles() == nullptr) return restart();
  session_.world().stepAvatars({}, 0.0);  // the avatars come back without sweeping
  return restartIn(std::move(session_.world()));
}

Result<void> WindowLoop::restart() {
  Result<World> world = worldAgain();
  if (!world) return world.error();
  if (Result<void> done = restartIn(std::move(*world)); !done) return done;
  saySettling();
  due_ = now();
  return {};
}

Result<void> WindowLoop::restartIn(World world) {
  Result<std::vector<std::unique_ptr<PoseSource>>> sources = subject_.sourcesAgain();
  if (!sources) return sources.error();
  hands_.rewind(session_);
  session_.restart(std::move(*sources), std::move(world));
  if (subject_.restarted) subject_.restarted();
  warnings_.clear();
  focus_.reset();
  started_ = ended_ = false;
  frameBegin_ = 0.0;
  due_ = now();
  return {};
}

Result<void> WindowLoop::beginSeek(double to) {
  // A held slider repeats its request, and the current frame may already be the requested one.
  if (seek_ && seek_->to == to) return {};
  if (started_ && to <= seconds() && (to > frameBegin_ || session_.frameCount() == 1)) return {};
  if (ended_ && to > seconds()) return {};
  if (!seek_) seek_ = Seek{to, now(), 0, false};
  seek_->to = to;
  if (!started_ || to > seconds()) return {};
  seek_->again = true;
  return restart();
}

Result<void> WindowLoop::runSeek() {
  const double until = now() + kSeekSlice;
  while (now() < until && !ended_ && (!started_ || seconds() < seek_->to)) {
    if (Result<void> done = step(); !done) return done;
    ++seek_->frames;
  }
  if (!ended_ && seconds() < seek_->to) {
    status_ =
        fmt::format("seeking {}to {:.1f} s: {:.1f} s", seek_->again ? "from the start " : "", seek_->to, seconds());
    return {};
  }
  const double took = now() - seek_->begun;
  if (took > kSoon) {
    window_.notice(fmt::format("ran {}{} to {:.1f} s in {:.1f} s", counted(seek_->frames, "frame"),
                               seek_->again ? " from the start" : "", seconds(), took));
  }
  seek_.reset();
  due_ = now();
  describe();
  return {};
}

/// Runs the frames that are due. Drawing may take longer than a frame, so several may be due; their number is limited
/// to keep the window responsive.
Result<void> WindowLoop::advance() {
  if (ended_) {
    goOn();
    return {};
  }
  for (int steps = 0; steps < kMaxStepsAPicture && !ended_; ++steps) {
    if (subject_.ready && !subject_.ready()) break;
    const bool live = subject_.duration <= 0.0;
    // Single steps are not timed.
    if (!live && !options_.hurry && !window_.paused() && now() < due_) break;
    if (!window_.wantsStep()) {
      due_ = now();
      break;
    }
    const double before = started_ ? session_.time() : 0.0;
    const bool first = !started_;
    if (Result<void> done = step(); !done) return done;
    if (ended_) break;
    describe();
    addStageTimes(session_, subject_.trackingSeconds ? std::optional(subject_.trackingSeconds()) : std::nullopt,
                  window_);
    if (live) break;  // only the latest frame counts
    const double length = first ? 0.0 : std::min(session_.time() - before, kLongestPause);
    due_ += length / window_.speed();
    // Catch up with late frames, but not after a long stop such as a pause or a dragged window.
    if (now() - due_ > kLongestPause) due_ = now();
  }
  return {};
}

/// The world after the end of the recording: the avatars stand, and what the user throws and drags still moves.
void WindowLoop::goOn() {
  if (!goesOn()) return;
  hands_.goOnWithout();
  std::vector<std::span<const LivePart>> standing;
  for (const SessionAvatar& avatar : session_.avatars()) standing.push_back(avatar.partsInWorld());
  for (int steps = 0; steps < kMaxStepsAPicture && (window_.paused() || now() >= due_); ++steps) {
    if (!window_.wantsStep()) {
      due_ = now();
      break;
    }
    hands_.beforeStep(window_, session_);
    session_.world().stepAvatars(standing, kAfterSeconds);
    due_ += kAfterSeconds / window_.speed();
    if (now() - due_ > kLongestPause) due_ = now();
  }
  describe();
}

Result<void> WindowLoop::step() {
  hands_.beforeStep(window_, session_);
  const double before = seconds();
  const Result<bool> more = session_.step();
  if (!more) return more.error();
  if (!*more) {
    ended_ = true;
    describe();
    return {};
  }
  if (!started_) firstTime_ = session_.time();
  started_ = true;
  frameBegin_ = before;
  focus_.update(session_);
  if (subject_.stepped) subject_.stepped();
  const bool over = (options_.frames > 0 && session_.frameCount() >= options_.frames) ||
                    (options_.seconds > 0.0 && seconds() >= options_.seconds);
  if (over) ended_ = true;
  return {};
}

void WindowLoop::show() {
  const double time = now();
  if (started_) raiseWarnings(session_, subject_.trouble ? subject_.trouble() : "", time, warnings_);
  warnings_.update(time);

  WindowValues values;
  values.name = subject_.name;
  values.status = status_;
  values.seconds = seek_ ? std::min(seconds(), seek_->to) : seconds();
  values.duration = subject_.duration;
  values.ended = ended_;
  values.parts = levels_.asked().value_or(static_cast<int>(session_.body().parts().size()));
  values.maxParts = onlyWatched() ? 0 : levels_.maxParts();
  values.preparingParts = levels_.asked().has_value();
  values.scenes = scenes_.names;
  values.scene = scenes_.present;
  values.expressions = expressions_;
  values.expression = expression_;
  values.warnings = warnings_.sentences();
  const auto outside = [](const SessionAvatar& avatar) { return avatar.present() && avatar.outsideKnownRange(); };
  values.outsideTraining = started_ && std::any_of(session_.avatars().begin(), session_.avatars().end(), outside);
  values.holdsProp = hands_.holds();
  values.focus = focus_.position();
  values.avatars = avatarNames_;
  values.avatar = focus_.avatar();
  values.noThrow = whyNoThrow();
  values.noUndo = whyNoUndo();
  values.noLoop = whyNoLoop();
  Scene scene;
  if (started_) {
    scene = scene_.of(session_, window_.shown(), window_.camera().eye);
    scene.inset = subject_.inset;
  }
  window_.show(scene, values);
}

}  // namespace

Result<WindowEnd> runInWindow(Window& window, WindowSubject& subject, const PlaybackOptions& options) {
  return WindowLoop(window, subject, options).run();
}

}  // namespace lorica
