#include "geometry/counts.h"
#include "geometry/text.h"
#include "player/window_loop_impl.h"
#include "prepare/scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lorica {
namespace {

constexpr double kHintSeconds = 10.0;

/// What the user should know of the motions that were read, such as that a file ends early.
std::string notesOf(const LoadedCast& loaded) {
  std::string notes;
  for (const CastMember& member : loaded.opened.avatars) {
    for (const std::string& note : member.motion().notes) {
      notes += fmt::format("{}{}: {}", notes.empty() ? "" : "; ", member.motion().name, note);
    }
  }
  return notes;
}

}  // namespace

Result<void> WindowLoop::answer(WindowRequests requests) {
  if (const std::string_view why = whyNoThrow(); !why.empty()) {
    if (requests.throwBall) window_.notice(std::string(why));
    requests.throwBall = false;
    requests.pressed.reset();
  }
  answerAboutAvatars(requests);
  open(requests);
  if (requests.undo) return undo();
  if (requests.cancel && nextWorld_) nextWorld_->cancel();
  if (requests.scene && *requests.scene != scenes_.present) prepareWorld(*requests.scene);
  hands_.take(requests, window_, window_.choices().follow ? focus_.position() : std::nullopt, session_);
  if (requests.parts && *requests.parts != levels_.asked().value_or(countOf(session_.body().parts()))) {
    levels_.ask(*requests.parts);
  }
  if (const std::shared_ptr<const BodyPlan> plan = levels_.take(); plan != nullptr && plan != session_.body().plan()) {
    session_.setBody(plan);
    firstParts_.clear();
    scene_ = SessionScene(session_);
    scene_.chooseExpression(expression_);
    describe();
  }
  if (requests.nextExpression) requests.expression = expression_ + 1;
  if (requests.expression && !expressions_.empty()) {
    expression_ = *requests.expression < countOf(expressions_) ? *requests.expression : -1;
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

/// Opens dropped files. The session goes on until they are loaded, and after an error.
void WindowLoop::open(const WindowRequests& requests) {
  WindowOpener* opener = subject_.opener;
  if (opener == nullptr) {
    if (!requests.files.empty()) window_.problem("files can be opened in the window of lorica play");
    return;
  }
  if (!requests.files.empty()) {
    if (const Result<WindowOpener::Others> begun = opener->open(requests.files); !begun) {
      window_.problem(begun.error().message);
    } else {
      remark_ = begun->remark;
      window_.notice(remark_, Window::kNoticeSeconds);  // or nothing any more of other files
      std::for_each(begun->files.rbegin(), begun->files.rend(),
                    [&](const std::string& other) { addRecent(other, settings_); });
    }
  }
  for (const Result<void>& begun : {requests.clip ? opener->openClip(*requests.clip) : Result<void>(),
                                    requests.person ? opener->openPerson(*requests.person) : Result<void>()}) {
    if (!begun) window_.problem(begun.error().message);
  }
  if (requests.cancel) opener->cancel();
  std::optional<Result<LoadedCast>> loaded = opener->take();
  if (!loaded) return;
  std::string said = *loaded ? notesOf(**loaded) : loaded->error().message;
  const bool failed = !*loaded && loaded->error().code != ErrorCode::kCancelled;
  if (failed) said += fmt::format("; still playing {}", subject_.name);
  if (!remark_.empty()) said += (said.empty() ? "" : "; ") + std::exchange(remark_, "");
  if (failed) {
    window_.problem(said);
  } else if (!said.empty()) {
    window_.notice(said, Window::kNoticeSeconds);
  }
  if (*loaded) subject_.next = std::move(**loaded);
}

void WindowLoop::answerAboutAvatars(const WindowRequests& requests) {
  if (requests.avatar) focus_.choose(*requests.avatar);
  if (!requests.clicked || avatarNames_.size() < 2) return;
  const int clicked = avatarAt(session_, *requests.clicked);
  focus_.choose(clicked);
  window_.notice(clicked < 0 ? "following all avatars" : "following avatar " + avatarNames_[clicked]);
}

Result<std::vector<std::unique_ptr<PoseSource>>> WindowLoop::sources() const {
  return subject_.treatment.sources ? subject_.treatment.sources(treatment_) : subject_.sourcesAgain();
}

/// Treats the motion and the world as the user chose: a recording runs again to the present time, a live session goes
/// on in a new world.
Result<void> WindowLoop::treat() {
  const WindowTreatment& chosen = window_.choices().treatment;
  if (!subject_.treatment.sources || chosen == treatment_) return {};
  const bool worldStays = chosen.gravity == treatment_.gravity && !subject_.sourcesAgain;
  if (chosen.mirror != treatment_.mirror || chosen.smoothing != treatment_.smoothing) firstParts_.clear();
  treatment_ = chosen;
  hands_.setGravity(kGravities[chosen.gravity].factor);
  if (worldStays) return restartIn(std::move(session_.world()));
  return runAgain();
}

/// Runs again to the present time.
Result<void> WindowLoop::runAgain() {
  if (started_ && subject_.sourcesAgain && !seek_) seek_ = Seek{seconds(), now(), 0, true};
  return restart();
}

/// Runs again to the present time without the last action.
Result<void> WindowLoop::undo() {
  if (const std::string_view why = whyNoUndo(); !why.empty()) {
    window_.notice(std::string(why));
    return {};
  }
  hands_.undo();
  return runAgain();
}

void WindowLoop::recallSettings() {
  treatment_ = subject_.treatment.first;
  Result<WindowSettings> read = readWindowSettings(windowSettingsFile());
  if (!read) {
    warn(read.error().message);
    window_.problem(read.error().message);
  } else {
    settings_ = keptSettings_ = std::move(*read);
  }
  if (const WindowOpener* opener = subject_.opener; opener != nullptr) {
    for (const std::string& file : opener->opened()) addRecent(file, settings_);
    if (read && settings_.recent.empty() && !opener->hint().empty()) {
      window_.notice(std::string(opener->hint()), kHintSeconds);
    }
  }
  WindowChoices choices = settings_.choices;
  choices.treatment = allowed(subject_.treatment, choices.treatment);
  window_.setChoices(choices);
  SceneOptions show = window_.shown();
  showKept(settings_, show);
  window_.setShown(show);
  firstShown_ = show;
}

void WindowLoop::keepSettings() {
  WindowSettings now = settings_;
  now.choices = window_.choices();
  // What could not be chosen was not.
  const TreatmentControl& control = subject_.treatment;
  WindowTreatment& treatment = now.choices.treatment;
  const WindowTreatment& kept = settings_.choices.treatment;
  if (!control.noMirror.empty()) treatment.mirror = kept.mirror;
  if (!control.noSmoothing.empty()) treatment.smoothing = kept.smoothing;
  if (!control.noGravity.empty()) treatment.gravity = kept.gravity;
  keepShown(firstShown_, window_.shown(), now);
  if (subject_.opener != nullptr) {
    for (const std::string& file : subject_.opener->opened()) addRecent(file, now);
  }
  if (now == keptSettings_) return;
  if (const Result<void> written = writeWindowSettings(windowSettingsFile(), now); !written) {
    warn(written.error().message);
  }
}

}  // namespace lorica
