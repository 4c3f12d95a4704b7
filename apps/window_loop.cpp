#include "apps/window_loop.h"

#include "apps/interrupt.h"
#include "apps/motions.h"
#include "apps/report.h"
#include "apps/scenes.h"
#include "apps/snapshots.h"
#include "apps/window_hands.h"
#include "apps/window_warnings.h"
#include "session/prepare/detail_levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>

namespace lorica {
namespace {

constexpr int kMaxStepsAPicture = 6;
constexpr double kLongestPause = 0.25;  // longer gaps in a recording, or while the window is dragged, are skipped [s]
constexpr double kSeekSlice = 0.04;     // duration of seeking between pictures [s]
constexpr double kSoon = 0.25;          // longer seeks are reported [s]
constexpr const char* kDemoScene = "boxes and balls";

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// The list of scenes: that of the demo, the shipped ones, and the user's own.
struct SceneList {
  std::vector<std::string> names{kDemoScene}, arguments{""};
  int present = 0;
};

SceneList scenesBeside(const std::string& present) {
  SceneList list;
  if (const Result<std::filesystem::path> folder = recordingsFolder()) {
    std::error_code ignored;
    std::vector<std::string> shipped;
    for (const auto& entry : std::filesystem::directory_iterator(folder->parent_path() / "scenes", ignored)) {
      if (entry.path().extension() == ".json") shipped.push_back(entry.path().stem().string());
    }
    std::sort(shipped.begin(), shipped.end());
    list.names.insert(list.names.end(), shipped.begin(), shipped.end());
    list.arguments.insert(list.arguments.end(), shipped.begin(), shipped.end());
  }
  auto found = std::find(list.arguments.begin(), list.arguments.end(), present);
  if (found == list.arguments.end()) {
    list.names.push_back(std::filesystem::path(present).filename().string());
    list.arguments.push_back(present);
    found = list.arguments.end() - 1;
  }
  list.present = static_cast<int>(found - list.arguments.begin());
  return list;
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
  [[nodiscard]] Result<World> worldAgain() const;
  Result<void> beginSeek(double to);
  Result<void> runSeek();
  Result<void> advance();
  Result<void> step();
  Result<void> restart();
  Result<void> changeScene(int scene);
  void saySettling();
  void noteTimes();
  void describe();
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
  std::optional<Seek> seek_;
  double due_;  // of the next frame [s]
  double firstTime_ = 0.0;
  double frameBegin_ = 0.0;  // time of the previous frame, since the first [s]
  bool started_ = false, ended_ = false;
  std::string status_;
  std::vector<int> touched_;
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
  saySettling();
  while (window_.open()) {
    if (interrupted()) return WindowEnd::kInterrupted;
    if (Result<void> done = answer(window_.takeRequests()); !done) return done.error();
    if (Result<void> done = seek_ ? runSeek() : advance(); !done) return done.error();
    if (started_ && subject_.enough && subject_.enough()) return WindowEnd::kOver;
    if (ended_ && !seek_) {
      if (subject_.atEnd == WindowSubject::AtEnd::kReturn) return WindowEnd::kOver;
      if (subject_.atEnd == WindowSubject::AtEnd::kRepeat) {
        hands_.forget();
        if (Result<void> done = restart(); !done) return done.error();
      }
    }
    show();
    // Limits the frame rate without vertical synchronisation.
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return WindowEnd::kClosed;
}

Result<void> WindowLoop::answer(WindowRequests requests) {
  if (requests.throwBall && (onlyWatched() || ended_)) {
    window_.notice(onlyWatched() ? "a recorded session cannot be changed" : "end of recording; press Home to restart");
  }
  if (onlyWatched() || ended_) {
    requests.throwBall = false;
    requests.pressed.reset();
  }
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

Result<void> WindowLoop::restart() {
  Result<World> world = worldAgain();
  if (!world) return world.error();
  Result<std::vector<std::unique_ptr<PoseSource>>> sources = subject_.sourcesAgain();
  if (!sources) return sources.error();
  hands_.rewind(session_);
  session_.restart(std::move(*sources), std::move(*world));
  if (subject_.restarted) subject_.restarted();
  warnings_.clear();
  started_ = ended_ = false;
  frameBegin_ = 0.0;
  saySettling();
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
    noteTimes();
    if (live) break;  // only the latest frame counts
    const double length = first ? 0.0 : std::min(session_.time() - before, kLongestPause);
    due_ += length / window_.speed();
    // Catch up with late frames, but not after a long stop such as a pause or a dragged window.
    if (now() - due_ > kLongestPause) due_ = now();
  }
  return {};
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
  if (subject_.stepped) subject_.stepped();
  const bool over = (options_.frames > 0 && session_.frameCount() >= options_.frames) ||
                    (options_.seconds > 0.0 && seconds() >= options_.seconds);
  if (over) ended_ = true;
  return {};
}

void WindowLoop::noteTimes() {
  const StageTimes& t = session_.times();
  std::array<TimedStage, 8> stages;
  std::size_t count = 0;
  const auto add = [&](const char* name, double microseconds) { stages[count++] = {name, 1e-3 * microseconds}; };
  if (subject_.trackingSeconds) add("joints", 1e6 * subject_.trackingSeconds());
  add("pose", t.retarget);
  if (session_.springs() != nullptr) add("springs", t.springs);
  add("motion", t.motion);
  add("points", t.points);
  add("hulls", t.hulls);
  add("physics", t.physics);
  if (session_.world().particles() != nullptr) add("particles", t.particles);
  window_.addTimes(std::span(stages).first(count));
}

void WindowLoop::describe() {
  std::ptrdiff_t parts = 0;
  for (const SessionAvatar& avatar : session_.avatars())
    parts += avatar.present() ? std::ssize(avatar.body().parts()) : 0;
  status_ = counted(parts, "part");
  touched_.clear();
  for (const Contact& contact : session_.world().contacts()) touched_.push_back(contact.prop);
  std::sort(touched_.begin(), touched_.end());
  touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
  if (!touched_.empty()) status_ += ", touching " + counted(std::ssize(touched_), "prop");
  if (ended_) status_ += ", end of recording";
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
