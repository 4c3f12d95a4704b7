#include "viewer/player/window_opener.h"

#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/text.h"
#include "session/prepare/file_kinds.h"
#include "skinning/import/character_file.h"
#include "viewer/player/window_settings.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <ctime>
#include <iterator>
#include <system_error>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMannequin = "mannequin";
constexpr std::size_t kMaxMeshes = 12;  // in one session
constexpr const char* kTemporary = ".tmp-";

/// A file of one, or the one that ships.
bool isCharacter(const std::string& name) {
  return name == kMannequin || kindOf(name) == FileKind::kCharacter;
}

/// Files by what they are.
struct Sorted {
  std::vector<std::string> characters, motions, scenes, bodies, meshes;
};

Sorted sorted(const std::vector<std::string>& files) {
  Sorted kinds;
  for (auto at = files.begin(); at != files.end(); ++at) {
    const std::string& file = *at;
    if (std::find(files.begin(), at, file) != at) continue;  // named twice
    const FileKind is = isCharacter(file) ? FileKind::kCharacter : kindOf(file);
    std::vector<std::string>& kind = is == FileKind::kCharacter       ? kinds.characters
                                     : is == FileKind::kMesh          ? kinds.meshes
                                     : is == FileKind::kScene         ? kinds.scenes
                                     : is == FileKind::kDecomposition ? kinds.bodies
                                                                      : kinds.motions;
    kind.push_back(file);
  }
  return kinds;
}

/// Of several files of one kind the first is opened.
WindowOpener::Others othersOf(const Sorted& kinds) {
  WindowOpener::Others others;
  std::vector<std::string> counts, used;
  for (const auto& [files, what] : {std::pair(&kinds.characters, "characters"), std::pair(&kinds.motions, "motions"),
                                    std::pair(&kinds.scenes, "scenes"), std::pair(&kinds.bodies, "decompositions")}) {
    if (files->size() < 2) continue;
    counts.push_back(fmt::format("{} {}", files->size(), what));
    used.push_back(fs::path(files->front()).filename().string());
    others.files.insert(others.files.end(), files->begin() + 1, files->end());
  }
  if (others.files.empty()) return others;
  const std::size_t found = others.files.size();
  if (found >= kMaxRecent) others.files.resize(kMaxRecent - 1);
  const std::ptrdiff_t avatars = std::count_if(others.files.begin(), others.files.end(), isCharacter);
  others.remark =
      fmt::format("found {} at once: took {}; {} in {}", listed(counts), listed(used),
                  found > others.files.size() ? fmt::format("{} of the other {} are", others.files.size(), found)
                  : found == 1                ? "the other is"
                                              : "the others are",
                  avatars == 0                          ? "the list `recent files`"
                  : avatars == std::ssize(others.files) ? "the list `avatar`"
                                                        : "the lists `avatar` and `recent files`");
  return others;
}

std::vector<std::string> shippedRecordings() {
  const Result<fs::path> folder = recordingsFolder();
  return folder ? shippedNames(*folder, {".csv"}) : std::vector<std::string>();
}

/// The newest files of a folder, the last one first, but those that are being written.
std::vector<std::string> newestIn(const fs::path& folder) {
  std::vector<std::pair<fs::file_time_type, std::string>> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().extension().string().starts_with(kTemporary) || !entry.is_regular_file(ignored)) continue;
    found.emplace_back(entry.last_write_time(ignored), entry.path().string());
  }
  std::sort(found.rbegin(), found.rend());
  found.resize(std::min(found.size(), kMaxRecent));
  std::vector<std::string> names;
  names.reserve(found.size());
  for (const auto& [time, name] : found) names.push_back(name);
  return names;
}

/// What a dropped character may be: one that performs the present motion or its own clip, or a motion.
std::vector<CastRequest> attemptsWith(const std::string& character, bool withMotion, const CastRequest& request) {
  CastRequest performs = request, own = request, moves = request;
  performs.character = own.character = character;
  own.motion = "";
  if (withMotion) return {performs};
  moves.motion = character;
  if (request.motion.empty()) return {own};
  return {performs, own, moves};
}

/// Without what was said about parts of other files.
CastRequest plain(CastRequest request) {
  request.reading.expressions.clear();
  request.reading.hidden.clear();
  request.reading.map.clear();
  const MotionOptions usual;
  request.performing.clip.clear();
  request.performing.rest.clear();
  request.performing.sender.clear();
  request.performing.inject = {};
  request.performing.smooth = usual.smooth;
  request.performing.smoothGiven = false;
  return request;
}

/// The options that one request has and the other does not.
std::vector<std::string> leftOut(const CastRequest& wanted, const CastRequest& made) {
  const CharacterOptions &a = wanted.reading, &b = made.reading;
  const MotionOptions &c = wanted.performing, &d = made.performing;
  std::vector<std::string> names;
  for (const auto& [differs, name] :
       {std::pair(a.expressions != b.expressions, "--expression"), std::pair(a.hidden != b.hidden, "--hide"),
        std::pair(a.map != b.map, "--map"), std::pair(c.clip != d.clip, "--clip"),
        std::pair(c.rest != d.rest, "--rest"), std::pair(c.sender != d.sender, "--sender"),
        std::pair(c.inject != d.inject, "--inject"), std::pair(c.smooth != d.smooth, "--smooth")}) {
    if (differs) names.emplace_back(name);
  }
  return names;
}

constexpr int kMaxOfADay = 999;
constexpr std::uintmax_t kLeastFree = std::uintmax_t{2} << 30;  // [bytes]

}  // namespace

Result<std::string> newDatedFile(const fs::path& folder, std::string_view ending) {
  std::error_code error;
  if (const fs::space_info space = fs::space(folder, error); error || space.available < kLeastFree) {
    return unwritable("{}: {}", folder.string(),
                      error ? error.message() : fmt::format("less than {} MiB free", kLeastFree >> 20));
  }
  const std::string day = fmt::format("{:%Y-%m-%d}", fmt::localtime(std::time(nullptr)));
  for (int number = 1; number <= kMaxOfADay; ++number) {
    const fs::path file = folder / fmt::format("{}_{:03}{}", day, number, ending);
    if (!fs::exists(file, error) &&
        !fs::exists(fs::path(file).replace_extension(fmt::format(".part{}", ending)), error))
      return file.string();
  }
  return unwritable("{}: {} files ({}) of {}", folder.string(), kMaxOfADay, ending, day);
}

WindowOpener::WindowOpener(const Cast& present, Host& host, std::string whyNot)
    : host_(host), whyNot_(std::move(whyNot)), motions_(shippedRecordings()) {
  remember(present);
}

WindowOpener::WindowOpener(CastRequest present, Host& host, std::string whyNot, Loader load)
    : present_(std::move(present)),
      host_(host),
      whyNot_(std::move(whyNot)),
      load_(std::move(load)),
      motions_(shippedRecordings()) {}

WindowOpener::~WindowOpener() {
  giveUp();
}

void WindowOpener::remember(const Cast& loaded) {
  present_ = loaded.request;
  choices_ = loaded.choices;
  // A scene with avatars of its own: a dropped character performs the motion of its first.
  if (present_.motion.empty() && present_.character.empty() && !loaded.avatars.empty()) {
    present_.motion = loaded.avatars.front().setting.motion;
  }
}

Result<WindowOpener::Others> WindowOpener::open(const std::vector<std::string>& files) {
  if (!whyNot_.empty()) return invalidArgument(whyNot_);
  // Names of what ships have no folder.
  dropped_ =
      dropped_ || std::any_of(files.begin(), files.end(), [](const fs::path& file) { return file.is_absolute(); });
  const Sorted kinds = sorted(files);
  Others others = othersOf(kinds);
  CastRequest request = present_;
  if (!kinds.scenes.empty()) request.scene = kinds.scenes.front();
  // A decomposition belongs to one character.
  if (!kinds.characters.empty()) request.body.decomposition.clear();
  if (!kinds.bodies.empty()) request.body.decomposition = kinds.bodies.front();
  if (!kinds.motions.empty()) {
    request.motion = kinds.motions.front();
    request.performing.clip.clear();
    request.performing.person = 0;
    request.performing.format.reset();
  }
  request.meshes.insert(request.meshes.end(), kinds.meshes.begin(), kinds.meshes.end());
  if (request.meshes.size() > kMaxMeshes) {
    return invalidArgument("found {} meshes, expected at most {} in a session", request.meshes.size(), kMaxMeshes);
  }
  std::vector<CastRequest> attempts{request};
  if (!kinds.characters.empty()) {
    attempts = attemptsWith(kinds.characters.front(), !kinds.motions.empty(), request);
  }
  for (std::size_t i = 0; i < attempts.size(); i += 2) attempts.insert(attempts.begin() + i + 1, plain(attempts[i]));
  attempts.erase(std::unique(attempts.begin(), attempts.end(),
                             [](const CastRequest& a, const CastRequest& b) {
                               return a.motion == b.motion && a.character == b.character && leftOut(a, b).empty();
                             }),
                 attempts.end());
  std::vector<std::string> opened;
  std::copy_if(files.begin(), files.end(), std::back_inserter(opened), [&](const std::string& file) {
    return std::find(others.files.begin(), others.files.end(), file) == others.files.end();
  });
  load(std::move(attempts), std::move(opened));
  opened_.insert(opened_.end(), others.files.rbegin(), others.files.rend());
  return others;
}

Result<void> WindowOpener::openReceived(const std::string& file) {
  Result<Others> begun = open({file});
  if (begun) {
    arriving_ = file;
    return {};
  }
  std::error_code ignored;
  fs::remove(file, ignored);
  return begun.error();
}

std::string_view WindowOpener::hint() const {
  return dropped_ || !whyNot_.empty() ? "" : "Drop a character, motion, scene or mesh here";
}

Result<void> WindowOpener::openClip(int index) {
  if (!whyNot_.empty()) return invalidArgument(whyNot_);
  CastRequest request = present_;
  request.performing.clip = choices_.clips[index];
  load({std::move(request)}, {});
  return {};
}

Result<void> WindowOpener::openPerson(int index) {
  if (!whyNot_.empty()) return invalidArgument(whyNot_);
  CastRequest request = present_;
  request.performing.person = index < 0 ? kEveryone : std::stoi(choices_.people[index]);
  load({std::move(request)}, {});
  return {};
}

/// @param files  that the user named
void WindowOpener::load(std::vector<CastRequest> attempts, std::vector<std::string> files) {
  asked_ = std::move(files);
  recordTo_.clear();
  giveUp();
  wanted_ = attempts.front();
  loading_ = std::make_unique<BackgroundWork<Cast>>(
      host_, [attempts = std::move(attempts), load = load_](Host& host) { return load(attempts, host); });
}

/// A file that people sent could name any other with --trust-paths.
void WindowOpener::recordInto(const std::string& folder) {
  recordings_ = folder;
  if (!folder.empty() && host_.paths != PathTrust::kAnywhere) sent_ = fs::absolute(folder) / kSentFolder;
}

std::string_view WindowOpener::noRecord() const {
  if (!whyNot_.empty()) return "what is written or sent is as the command says";
  return recordings_.empty() ? "recordings need a folder on the machine that serves: start with --recordings DIR" : "";
}

Result<void> WindowOpener::record() {
  if (const std::string_view why = noRecord(); !why.empty()) return invalidArgument("{}", why);
  LORICA_TRY(std::string file, newDatedFile(recordings_, ".lsession"));
  load({present_}, {});
  recordTo_ = std::move(file);
  return {};
}

void WindowOpener::cancel() {
  cancelled_ = cancelled_ || loading_ != nullptr;
  giveUp();
}

void WindowOpener::giveUp() {
  if (loading_) loading_->abandon();
  loading_.reset();
  std::error_code ignored;
  if (!arriving_.empty()) fs::remove(std::exchange(arriving_, ""), ignored);
}

std::optional<Result<Cast>> WindowOpener::take() {
  if (std::exchange(cancelled_, false)) return cancelled();
  if (!loading_) return std::nullopt;
  std::optional<Result<Cast>> result = loading_->take();
  if (!result) return result;
  if (*result) arriving_.clear();
  giveUp();
  if (*result) {
    if (const std::vector<std::string> names = leftOut(wanted_, (*result)->request); !names.empty()) {
      host_.warn(fmt::format("{} {} not fit what was opened and {} left out", listed(names),
                             names.size() == 1 ? "does" : "do", names.size() == 1 ? "is" : "are"));
    }
    remember(**result);
    std::copy_if(asked_.begin(), asked_.end(), std::back_inserter(opened_),
                 [this](const std::string& file) { return !isSent(file); });
  }
  return result;
}

void WindowOpener::list(const std::vector<std::string>& recent) {
  characters_.clear();
  recent_.clear();
  std::size_t own = 0;
  for (const std::vector<std::string>& files : {recent, newestIn(sent_)}) {
    own = recent_.size();
    for (const std::string& file : files) {
      if (file != arriving_) (isCharacter(file) ? characters_ : recent_).push_back(file);
    }
  }
  sentRecent_ = recent_.size() - own;
  // A character's own file may be the motion.
  const std::string shown = !present_.character.empty()    ? present_.character
                            : isCharacter(present_.motion) ? present_.motion
                                                           : kMannequin;
  for (const std::string& one : {shown, std::string(kMannequin)}) {
    const bool known = std::find(characters_.begin(), characters_.end(), one) != characters_.end();
    if (!known && isCharacter(one)) characters_.push_back(one);
  }
  const auto found = std::find(characters_.begin(), characters_.end(), shown);
  character_ = found == characters_.end() ? -1 : found - characters_.begin();
}

void WindowOpener::listControls(Controls& controls) const {
  controls.offer(ControlId::kOpen).whyNot = whyNot_;
  if (!whyNot_.empty()) return;
  controls.offer(ControlId::kCharacter, characters_, character_);
  const auto present = std::find(motions_.begin(), motions_.end(), present_.motion);
  controls.offer(ControlId::kMotion, motions_,
                 present == motions_.end() ? -1 : static_cast<int>(present - motions_.begin()));
  controls.offer(ControlId::kClip, choices_.clips, choices_.clip);
  controls.offer(ControlId::kPerson, choices_.people, choices_.person);
  controls[ControlId::kPerson].none = "everyone";
  controls[ControlId::kPerson].least = choices_.everyone ? -1.0 : 0.0;
  controls.offer(ControlId::kRecent, recent_, -1);
  controls.offer(ControlId::kSent, std::span(recent_).last(sentRecent_), -1);
  for (const ControlId id : {ControlId::kRecent, ControlId::kSent}) controls[id].none = "open again ...";
}

void WindowOpener::describe(WindowValues& values) {
  values.hint = hint();
  if (!loading_) return;
  progress_ = loading_->progress();
  values.loading = progress_.title();
  values.loaded = progress_.share;
}

}  // namespace lorica
