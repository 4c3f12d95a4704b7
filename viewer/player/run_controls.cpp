#include "geometry/counts.h"
#include "geometry/text.h"
#include "session/prepare/scenes.h"
#include "viewer/player/run_loop.h"
#include "viewer/player/snapshots.h"

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

/// The list as it is now.
void RunLoop::listControls() {
  using Id = ControlId;
  listChoices(screen_->choices(), controls_);
  const bool recorded = run_.duration() > 0.0;
  for (const Id id : {Id::kSpeed, Id::kLoop}) controls_[id].absent = !recorded;
  controls_.offer(Id::kRestart).absent = !recorded;
  Control& seek = controls_.offer(Id::kSeek);
  seek.absent = !recorded;
  seek.most = run_.duration();
  seek.value = seekTo_.value_or(seek_ ? seek_->to : seconds());
  Control& parts = controls_.offer(Id::kParts);
  parts.least = 1.0;
  parts.most = onlyWatched() ? 0.0 : levels_->maxParts();
  parts.value = levels_->asked().value_or(countOf(session_.body().parts()));
  parts.absent = parts.most < parts.least;
  if (levels_->asked()) parts.label = "parts ...";  // it is computed
  controls_.offer(Id::kScene, scenes_.names, scenes_.present);
  controls_.offer(Id::kExpression, expressions_, expression_);
  controls_[Id::kExpression].least = -1.0;
  controls_[Id::kExpression].none = expression_ == kExpressionsAsGiven ? "as given" : "none";
  controls_.offer(Id::kAvatar, avatarNames_, focus_.avatar());
  controls_[Id::kAvatar].absent = controls_[Id::kClick].absent = avatarNames_.size() < 2;
  controls_[Id::kMirror].whyNot = run_.treatment.noMirror;
  controls_[Id::kSmoothing].whyNot = run_.treatment.noSmoothing;
  controls_[Id::kGravity].whyNot = run_.treatment.noGravity;
  for (const Id id : {Id::kMirror, Id::kSmoothing, Id::kGravity}) controls_[id].absent = !run_.treatable();
  for (const Id id : {Id::kThrow, Id::kUndo, Id::kRecord, Id::kFindCamera, Id::kCancel}) controls_.offer(id);
  for (const Id id : {Id::kLoop, Id::kThrow, Id::kUndo, Id::kRecord}) controls_[id].whyNot = whyNot(id);
  Control& record = controls_[Id::kRecord];
  record.value = run_.recorder ? 1.0 : 0.0;
  if (run_.recorder) record.label = "end the recording";
  if (shown_.opener != nullptr) {
    shown_.opener->listControls(controls_);
  } else {
    controls_[Id::kOpen].whyNot = kWrittenOnce;
  }
}

Result<void> RunLoop::answer(const std::vector<Change>& changes) {
  for (const Change& change : changes) {
    listControls();  // what was done before is seen
    perform(change);
  }
  takeLoaded();
  const bool cut = run_.recorder && (run_.recorder->cutShort() || run_.recorder->full());
  if (cut && whyNot(ControlId::kRecord).empty()) record(false);  // the session started again, or the file is full
  if (const std::shared_ptr<const BodyPlan> plan = levels_->take(); plan != nullptr && plan != session_.body().plan()) {
    session_.setBody(plan);
    ++changes_;
    firstParts_.clear();
    scene_.emplace(session_);
    if (expression_ != kExpressionsAsGiven) scene_->chooseExpression(expression_);
    describe();
  }
  if (std::exchange(forgetsLast_, false)) {
    hands_.forgetLast();
    return runAgain("undone");
  }
  if (const std::optional<double> to = std::exchange(seekTo_, std::nullopt)) return beginSeek(*to);
  return {};
}

void RunLoop::perform(const Change& change) {
  const Control& control = controls_[change.id];
  if (!change.files.empty()) return open(change);
  if (!control.whyNot.empty() && control.kind == ControlKind::kButton) {
    return screen_->notice(std::string(control.whyNot));
  }
  const std::optional<double> value = valueAfter(control, change);
  if (control.absent || !control.whyNot.empty() || !value) return;
  const int index = static_cast<int>(*value);
  switch (change.id) {
    case ControlId::kPress:
      if (!controls_[ControlId::kThrow].whyNot.empty()) return;
      [[fallthrough]];
    case ControlId::kRelease:
    case ControlId::kThrow:
      return hands_.take(change, *screen_, screen_->choices().follow ? focus_.position() : std::nullopt, session_);
    case ControlId::kClick:
      focus_.choose(avatarAt(session_, change.ray));
      return screen_->notice(focus_.avatar() < 0 ? "following all avatars"
                                                 : "following avatar " + avatarNames_[focus_.avatar()]);
    case ControlId::kAvatar:
      return focus_.choose(index);
    case ControlId::kUndo:
      forgetsLast_ = true;
      return;
    case ControlId::kRestart:
    case ControlId::kSeek:
      seekTo_ = change.id == ControlId::kSeek ? *value : 0.0;
      return;
    case ControlId::kParts:
      if (*value != control.value) levels_->ask(index);
      return;
    case ControlId::kScene:
      if (index != scenes_.present) prepareWorld(index);
      return;
    case ControlId::kExpression:
      ++changes_;
      expression_ = index;
      return scene_->chooseExpression(expression_);
    case ControlId::kRecord:
      return record(*value != 0.0);
    case ControlId::kFindCamera:
      return headset_.forget();
    case ControlId::kCancel:
      if (nextWorld_) nextWorld_->cancel();
      if (shown_.opener != nullptr) shown_.opener->cancel();
      return;
    case ControlId::kOpen:
      return screen_->chooseFiles();
    case ControlId::kCharacter:
    case ControlId::kMotion:
    case ControlId::kRecent:
    case ControlId::kSent:
      return open({.id = ControlId::kOpen, .files = {control.choices[static_cast<std::size_t>(index)]}});
    case ControlId::kClip:
      return report(shown_.opener->openClip(index));
    case ControlId::kPerson:
      return report(shown_.opener->openPerson(index));
    default:
      return;  // a screen's own
  }
}

void RunLoop::report(const Result<void>& done) {
  if (!done) screen_->problem(done.error().message);
}

/// Why something cannot be done; empty = it can.
std::string_view RunLoop::whyNot(ControlId id) const {
  switch (id) {
    case ControlId::kThrow:
      if (onlyWatched()) return "a recorded session cannot be changed";
      return ended_ && !goesOn() ? "end of recording; press Home to restart" : "";
    case ControlId::kUndo:
      if (onlyWatched()) return "a recorded session cannot be changed";
      if (!run_.restartable()) return "what happened live cannot be undone";
      return hands_.hasLast() ? "" : "nothing was thrown or dragged";
    case ControlId::kLoop:
      return mayLoop() ? "" : onlyWatched() ? "a recorded session is run once" : "what is written is run once";
    case ControlId::kRecord:
      if (onlyWatched() || shown_.opener == nullptr) return "a recorded session is not recorded again";
      return shown_.opener->noRecord();
    default:
      return {};
  }
}

/// A recording begins with the session at its start, which the command opens again as it was asked for.
void RunLoop::record(bool on) {
  const std::string name = std::filesystem::path(run_.setting.record).filename().string();
  if (on && name.empty()) {
    report(shown_.opener->record());
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

/// Opens files that were dropped, chosen or sent. The session goes on until they are loaded, and after an error.
void RunLoop::open(const Change& change) {
  WindowOpener* opener = shown_.opener;
  if (opener == nullptr) return screen_->problem("files can be opened in the window of lorica play");
  if (change.client != 0) {
    for (const std::string& file : change.files) report(opener->openReceived(file));
    return;
  }
  const Result<WindowOpener::Others> begun = opener->open(change.files);
  if (!begun) return screen_->problem(begun.error().message);
  remark_ = begun->remark;
  screen_->notice(remark_, Screen::kNoticeSeconds);  // or nothing any more of other files
  std::for_each(begun->files.rbegin(), begun->files.rend(),
                [&](const std::string& other) { addRecent(other, settings_); });
  opener->list(settings_.recent);
}

/// What was opened is the next run, once it is loaded.
void RunLoop::takeLoaded() {
  WindowOpener* opener = shown_.opener;
  std::optional<Result<Cast>> loaded = opener != nullptr ? opener->take() : std::nullopt;
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

Result<std::vector<std::unique_ptr<PoseSource>>> RunLoop::sources() const {
  return openSources(run_.cast, treated(run_.cast.request.performing, treatment_));
}

/// Treats the motion and the world as the user chose: a recording runs again to the present time, a live session goes
/// on in a new world.
Result<void> RunLoop::treat() {
  const Treatment chosen = screen_->choices().treatment = allowed(run_.treatment, screen_->choices().treatment);
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
  Choices& choices = screen_->choices();
  static_cast<KeptChoices&>(choices) = settings_.choices;
  choices.treatment = allowed(run_.treatment, choices.treatment);
  if (!run_.setting.allLayers) showKept(settings_, choices.show);
  if (shown_.background != nullptr) setBackground(*shown_.background, choices.show);
  firstShown_ = choices.show;
}

void RunLoop::keepSettings() {
  WindowSettings now = settings_;
  now.choices = screen_->choices();
  // What could not be chosen was not.
  TreatmentControl control = run_.treatment;
  control.first = settings_.choices.treatment;
  now.choices.treatment = allowed(control, now.choices.treatment);
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
