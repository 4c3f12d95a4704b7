#include "geometry/counts.h"
#include "geometry/text.h"
#include "player/run_loop.h"
#include "prepare/scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace lorica {
namespace {

/// What the user should know of the motions that were read, such as that a file ends early.
std::string notesOf(const Cast& loaded) {
  std::string notes;
  for (const PreparedAvatar& avatar : loaded.avatars) {
    if (!avatar.motion) continue;  // it follows a camera
    for (const std::string& note : avatar.motion->notes) {
      notes += fmt::format("{}{}: {}", notes.empty() ? "" : "; ", avatar.motion->name, note);
    }
  }
  return notes;
}

}  // namespace

Result<void> RunLoop::answer(WindowRequests requests) {
  if (const std::string_view why = whyNoThrow(); !why.empty()) {
    if (requests.throwBall) screen_->notice(std::string(why));
    requests.throwBall = false;
    for (HandRequests& hand : requests.hands) hand.pressed.reset();
  }
  answerAboutAvatars(requests);
  open(requests);
  const bool cut = run_.recorder && (run_.recorder->cutShort() || run_.recorder->full());
  if (cut && whyNoRecord().empty()) record(false);  // the session started again, or the file is full
  if (requests.record) record(*requests.record);
  if (requests.undo && whyNoUndo().empty()) return undo();
  if (requests.undo) screen_->notice(std::string(whyNoUndo()));
  if (requests.cancel && nextWorld_) nextWorld_->cancel();
  if (requests.findCamera) headset_.forget();
  if (requests.scene && *requests.scene != scenes_.present) prepareWorld(*requests.scene);
  hands_.take(requests, *screen_, screen_->choices().follow ? focus_.position() : std::nullopt, session_);
  if (requests.parts && *requests.parts != levels_->asked().value_or(countOf(session_.body().parts()))) {
    levels_->ask(*requests.parts);
  }
  if (const std::shared_ptr<const BodyPlan> plan = levels_->take(); plan != nullptr && plan != session_.body().plan()) {
    session_.setBody(plan);
    ++changes_;
    firstParts_.clear();
    scene_.emplace(session_);
    if (expression_ != kExpressionsAsGiven) scene_->chooseExpression(expression_);
    describe();
  }
  if (requests.nextExpression) requests.expression = std::max(expression_, -1) + 1;
  if (requests.expression && !expressions_.empty()) {
    ++changes_;
    expression_ = *requests.expression < countOf(expressions_) ? *requests.expression : -1;
    scene_->chooseExpression(expression_);
  }
  if (requests.seekTo && run_.restartable()) return beginSeek(*requests.seekTo);
  return {};
}

std::string_view RunLoop::whyNoThrow() const {
  if (onlyWatched()) return "a recorded session cannot be changed";
  if (ended_ && !goesOn()) return "end of recording; press Home to restart";
  return {};
}

std::string_view RunLoop::whyNoUndo() const {
  if (onlyWatched()) return "a recorded session cannot be changed";
  if (!run_.restartable()) return "what happened live cannot be undone";
  if (!hands_.canUndo()) return "nothing was thrown or dragged";
  return {};
}

std::string_view RunLoop::whyNoLoop() const {
  return mayLoop() ? "" : onlyWatched() ? "a recorded session is run once" : "what is written is run once";
}

std::string_view RunLoop::whyNoRecord() const {
  if (onlyWatched() || shown_.opener == nullptr) return "a recorded session is not recorded again";
  return shown_.opener->noRecord();
}

/// A recording begins with the session at its start, which the command opens again as it was asked for.
void RunLoop::record(bool on) {
  if (const std::string_view why = whyNoRecord(); !why.empty()) return screen_->notice(std::string(why));
  const std::string name = std::filesystem::path(run_.setting.record).filename().string();
  if (on && name.empty()) {
    if (const Result<void> begun = shown_.opener->record(); !begun) screen_->problem(begun.error().message);
  } else if (!on && run_.recorder) {
    const Result<int> steps = run_.stopRecording();
    if (!steps) return screen_->problem(steps.error().message);
    screen_->notice(fmt::format("recorded {} in {}", counted(*steps, "step"), name), Screen::kNoticeSeconds);
  }
}

bool RunLoop::loops() const {
  if (!mayLoop()) return false;
  return run_.setting.atEnd == AtEnd::kRepeat || screen_->choices().loop;
}

/// Opens dropped files. The session goes on until they are loaded, and after an error.
void RunLoop::open(const WindowRequests& requests) {
  WindowOpener* opener = shown_.opener;
  if (opener != nullptr && requests.choose) screen_->chooseFiles();
  if (opener == nullptr) {
    if (!requests.files.empty() || !requests.received.empty())
      screen_->problem("files can be opened in the window of lorica play");
    return;
  }
  if (!requests.files.empty()) {
    if (const Result<WindowOpener::Others> begun = opener->open(requests.files); !begun) {
      screen_->problem(begun.error().message);
    } else {
      remark_ = begun->remark;
      screen_->notice(remark_, Screen::kNoticeSeconds);  // or nothing any more of other files
      std::for_each(begun->files.rbegin(), begun->files.rend(),
                    [&](const std::string& other) { addRecent(other, settings_); });
      opener->list(settings_.recent);
    }
  }
  for (const Result<void>& begun :
       {requests.received.empty() ? Result<void>() : opener->openReceived(requests.received),
        requests.clip ? opener->openClip(*requests.clip) : Result<void>(),
        requests.person ? opener->openPerson(*requests.person) : Result<void>()}) {
    if (!begun) screen_->problem(begun.error().message);
  }
  if (requests.cancel) opener->cancel();
  std::optional<Result<Cast>> loaded = opener->take();
  if (!loaded) return;
  std::string said = *loaded ? notesOf(**loaded) : loaded->error().message;
  const bool failed = !*loaded && loaded->error().code != ErrorCode::kCancelled;
  if (failed) said += fmt::format("; still playing {}", run_.name());
  if (!remark_.empty()) said += (said.empty() ? "" : "; ") + std::exchange(remark_, "");
  if (failed) {
    screen_->problem(said);
  } else if (!said.empty()) {
    screen_->notice(said, Screen::kNoticeSeconds);
  }
  if (!*loaded) return;
  shown_.next = std::move(**loaded);
  shown_.record = opener->takeRecord();
}

void RunLoop::answerAboutAvatars(const WindowRequests& requests) {
  if (requests.avatar) focus_.choose(*requests.avatar);
  if (!requests.clicked || avatarNames_.size() < 2) return;
  const int clicked = avatarAt(session_, *requests.clicked);
  focus_.choose(clicked);
  screen_->notice(clicked < 0 ? "following all avatars" : "following avatar " + avatarNames_[clicked]);
}

Result<std::vector<std::unique_ptr<PoseSource>>> RunLoop::sources() const {
  return openSources(run_.cast, treated(run_.cast.request.performing, treatment_));
}

/// Treats the motion and the world as the user chose: a recording runs again to the present time, a live session goes
/// on in a new world.
Result<void> RunLoop::treat() {
  const WindowTreatment& chosen = screen_->choices().treatment;
  if (!run_.treatable() || chosen == treatment_) return {};
  const bool worldStays = chosen.gravity == treatment_.gravity && !run_.restartable();
  if (chosen.mirror != treatment_.mirror || chosen.smoothing != treatment_.smoothing) firstParts_.clear();
  treatment_ = chosen;
  hands_.setGravity(kGravities[chosen.gravity].factor);
  if (worldStays) return restartIn(std::move(session_.world()));
  return runAgain();
}

/// Runs again to the present time. @param done  said then
Result<void> RunLoop::runAgain(std::string_view done) {
  if (started_ && run_.restartable() && !seek_) seek_ = Seek{seconds(), done};
  return restart();
}

/// Runs again to the present time without the last action.
Result<void> RunLoop::undo() {
  hands_.undo();
  return runAgain("undone");
}

void RunLoop::recallSettings() {
  treatment_ = run_.treatment.first;
  Result<WindowSettings> read = readWindowSettings(windowSettingsFile());
  if (!read) {
    host_.warn(read.error().message);
    screen_->problem(read.error().message);
  } else {
    settings_ = keptSettings_ = std::move(*read);
  }
  if (const WindowOpener* opener = shown_.opener; opener != nullptr) {
    for (const std::string& file : opener->opened()) addRecent(file, settings_);
  }
  if (shown_.opener != nullptr) shown_.opener->list(settings_.recent);
  WindowChoices choices = screen_->choices();
  static_cast<KeptChoices&>(choices) = settings_.choices;
  choices.treatment = allowed(run_.treatment, choices.treatment);
  if (!run_.setting.allLayers) showKept(settings_, choices.show);
  firstShown_ = choices.show;
  screen_->setChoices(choices);
}

void RunLoop::keepSettings() {
  WindowSettings now = settings_;
  now.choices = screen_->choices();
  // What could not be chosen was not.
  const TreatmentControl& control = run_.treatment;
  WindowTreatment& treatment = now.choices.treatment;
  const WindowTreatment& kept = settings_.choices.treatment;
  if (!control.noMirror.empty()) treatment.mirror = kept.mirror;
  if (!control.noSmoothing.empty()) treatment.smoothing = kept.smoothing;
  if (!control.noGravity.empty()) treatment.gravity = kept.gravity;
  keepShown(firstShown_, screen_->choices().show, now);
  if (shown_.opener != nullptr) {
    for (const std::string& file : shown_.opener->opened()) addRecent(file, now);
  }
  if (now == keptSettings_) return;
  if (const Result<void> written = writeWindowSettings(windowSettingsFile(), now); !written) {
    host_.warn(written.error().message);
  }
}

}  // namespace lorica
