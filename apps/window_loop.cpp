#include "apps/window_loop.h"

#include "apps/detail_levels.h"
#include "apps/interrupt.h"
#include "apps/motions.h"
#include "apps/report.h"
#include "apps/scenes.h"
#include "apps/snapshots.h"
#include "apps/window_hands.h"
#include "apps/window_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>

namespace lorica {
namespace {

constexpr int kMostStepsAPicture = 6;
constexpr double kLongestPause = 0.25;  // [s]: a gap in a recording, or a dragged window, is not waited out
constexpr double kSeekSlice = 0.04;     // of running to a time, between pictures [s]
constexpr double kSoon = 0.25;          // a run that takes longer is told of [s]
constexpr const char* kDemoScene = "boxes and balls";

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// What a scene's list shows: the demo's, those that ship, and one of the user's own.
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
        scenes_(subject.worldAnew ? SceneList{{}, {}} : scenesBeside(subject.scene)),
        scene_(session_),
        levels_(session_.body().plan(), session_.character()),
        hands_(subject.sourceAnew != nullptr),
        due_(now()) {}

  Result<WindowEnd> run();

 private:
  /// Where a recording is run to without pictures.
  struct Seek {
    double to = 0.0;     // [s]
    double begun = 0.0;  // [s]
    int frames = 0;
    bool anew = false;  // from the start
  };

  [[nodiscard]] bool onlyWatched() const { return subject_.worldAnew != nullptr; }
  [[nodiscard]] double seconds() const { return started_ ? session_.time() - firstTime_ : 0.0; }
  Result<void> answer(WindowRequests requests);
  [[nodiscard]] Result<World> worldAnew() const;
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
  double frameBegin_ = 0.0;  // time of the frame before this one, since the first [s]
  bool started_ = false, ended_ = false;
  std::string status_;
  std::vector<int> touched_;
};

// The first step takes seconds where sand settles in it: the window says so before, with a picture.
void WindowLoop::saySettling() {
  const Particles* particles = session_.world().particles();
  if (particles == nullptr || particles->settings().settleSeconds <= 0.0) return;
  window_.notice("sand and water settle first");
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
    // Where the display does not hold us back, this does.
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return WindowEnd::kClosed;
}

Result<void> WindowLoop::answer(WindowRequests requests) {
  if (requests.throwBall && (onlyWatched() || ended_)) {
    window_.notice(onlyWatched() ? "a recorded session is only watched" : "it is over: home begins anew");
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
    describe();
  }
  if (requests.seekTo && subject_.sourceAnew) return beginSeek(*requests.seekTo);
  return {};
}

Result<void> WindowLoop::changeScene(int scene) {
  Result<World> world = openScene(scenes_.arguments[static_cast<std::size_t>(scene)]);
  if (!world) {
    window_.notice(world.error().message);
    return {};
  }
  scenes_.present = scene;
  hands_.forget();
  if (subject_.sourceAnew) return restart();
  session_.setWorld(std::move(*world));
  saySettling();
  return {};
}

/// The session's own, or of the scene that was chosen last.
Result<World> WindowLoop::worldAnew() const {
  if (onlyWatched()) return subject_.worldAnew();
  return openScene(scenes_.arguments[static_cast<std::size_t>(scenes_.present)]);
}

Result<void> WindowLoop::restart() {
  Result<World> world = worldAnew();
  if (!world) return world.error();
  Result<std::unique_ptr<PoseSource>> source = subject_.sourceAnew();
  if (!source) return source.error();
  hands_.rewind(session_);
  session_.restart(std::move(*source), std::move(*world));
  if (subject_.restarted) subject_.restarted();
  warnings_.clear();
  started_ = ended_ = false;
  frameBegin_ = 0.0;
  saySettling();
  due_ = now();
  return {};
}

Result<void> WindowLoop::beginSeek(double to) {
  // A slider that is held asks again and again, and this frame may be the one.
  if (seek_ && seek_->to == to) return {};
  if (started_ && to <= seconds() && (to > frameBegin_ || session_.frameCount() == 1)) return {};
  if (ended_ && to > seconds()) return {};
  if (!seek_) seek_ = Seek{to, now(), 0, false};
  seek_->to = to;
  if (!started_ || to > seconds()) return {};
  seek_->anew = true;
  return restart();
}

Result<void> WindowLoop::runSeek() {
  const double until = now() + kSeekSlice;
  while (now() < until && !ended_ && (!started_ || seconds() < seek_->to)) {
    if (Result<void> done = step(); !done) return done;
    ++seek_->frames;
  }
  if (!ended_ && seconds() < seek_->to) {
    status_ = fmt::format("running {} to {:.1f} s: {:.1f} s", seek_->anew ? "anew" : "on", seek_->to, seconds());
    return {};
  }
  const double took = now() - seek_->begun;
  if (took > kSoon) {
    window_.notice(fmt::format("ran {}{} to {:.1f} s in {:.1f} s", counted(seek_->frames, "frame"),
                               seek_->anew ? " anew from the start" : "", seconds(), took));
  }
  seek_.reset();
  due_ = now();
  describe();
  return {};
}

/// The frames that are due. A picture may take longer than a frame: what is due is computed, up to a limit that keeps
/// the window alive.
Result<void> WindowLoop::advance() {
  for (int steps = 0; steps < kMostStepsAPicture && !ended_; ++steps) {
    if (subject_.ready && !subject_.ready()) break;
    const bool live = subject_.duration <= 0.0;
    // A single step is not a matter of pace.
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
    if (live) break;  // there is only the latest
    const double length = first ? 0.0 : std::min(session_.time() - before, kLongestPause);
    due_ += length / window_.speed();
    // Late frames are caught up, but a long stop (a pause, a dragged window) is not.
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
  std::array<TimedStage, 7> stages;
  std::size_t count = 0;
  const auto add = [&](const char* name, double microseconds) { stages[count++] = {name, 1e-3 * microseconds}; };
  if (subject_.trackingSeconds) add("joints", 1e6 * subject_.trackingSeconds());
  add("pose", t.retarget);
  add("motion", t.motion);
  add("points", t.points);
  add("hulls", t.hulls);
  add("physics", t.physics);
  if (session_.world().particles() != nullptr) add("particles", t.particles);
  window_.addTimes(std::span(stages).first(count));
}

void WindowLoop::describe() {
  status_ = counted(std::ssize(session_.body().parts()), "part");
  touched_.clear();
  for (const Contact& contact : session_.world().contacts()) touched_.push_back(contact.prop);
  std::sort(touched_.begin(), touched_.end());
  touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
  if (!touched_.empty()) status_ += ", touching " + counted(std::ssize(touched_), "thing");
  if (ended_) status_ += ", the end";
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
  values.mostParts = onlyWatched() ? 0 : levels_.mostParts();
  values.preparingParts = levels_.asked().has_value();
  values.scenes = scenes_.names;
  values.scene = scenes_.present;
  values.warnings = warnings_.sentences();
  values.holdsProp = hands_.holds();
  Scene scene;
  if (started_) {
    scene = scene_.of(session_);
    scene.inset = subject_.inset;
  }
  window_.show(scene, values);
}

}  // namespace

Result<WindowEnd> runInWindow(Window& window, WindowSubject& subject, const PlaybackOptions& options) {
  return WindowLoop(window, subject, options).run();
}

}  // namespace lorica
