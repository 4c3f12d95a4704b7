#include "player/window_opener.h"

#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/text.h"
#include "player/window_settings.h"
#include "skinning/import/character_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxMeshes = 12;         // in one session
constexpr std::streamsize kSceneBegin = 4096;  // within which a scene file says what it is [bytes]

bool isMeshFile(const fs::path& file) {
  const std::string extension = lowerCase(file.extension().string());
  return extension == ".off" || extension == ".obj" || extension == ".ply" || extension == ".stl";
}

bool isSceneFile(const fs::path& file) {
  if (lowerCase(file.extension().string()) != ".json") return false;
  std::ifstream stream(file, std::ios::binary);
  std::string begin(kSceneBegin, '\0');
  stream.read(begin.data(), kSceneBegin);
  begin.resize(std::max<std::streamsize>(stream.gcount(), 0));
  return begin.find("lorica scene") != std::string::npos;
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
    const fs::path path(file);
    std::vector<std::string>& kind = isCharacterFile(path)                               ? kinds.characters
                                     : isMeshFile(path)                                  ? kinds.meshes
                                     : isSceneFile(path)                                 ? kinds.scenes
                                     : lowerCase(path.extension().string()) == ".lorica" ? kinds.bodies
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
  others.remark =
      fmt::format("found {} at once: took {}; {} in the list `files`", listed(counts), listed(used),
                  found > others.files.size() ? fmt::format("{} of the other {} are", others.files.size(), found)
                  : found == 1                ? "the other is"
                                              : "the others are");
  return others;
}

std::vector<std::string> shippedMotions() {
  std::vector<std::string> names;
  const Result<fs::path> folder = recordingsFolder();
  if (!folder) return names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(*folder, ignored)) {
    if (entry.path().extension() == ".csv") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
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

}  // namespace

WindowOpener::WindowOpener(const Cast& present, Host& host, std::string whyNot)
    : host_(host), whyNot_(std::move(whyNot)), motions_(shippedMotions()) {
  remember(present);
}

WindowOpener::WindowOpener(CastRequest present, Host& host)
    : present_(std::move(present)), host_(host), motions_(shippedMotions()) {}

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
    request.performing.format.clear();
  }
  request.meshes.insert(request.meshes.end(), kinds.meshes.begin(), kinds.meshes.end());
  if (request.meshes.size() > kMaxMeshes) {
    return invalidArgument("found {} meshes, expected at most {} in a session", request.meshes.size(), kMaxMeshes);
  }
  std::vector<CastRequest> attempts{request};
  if (!kinds.characters.empty()) {
    attempts = attemptsWith(kinds.characters.front(), !kinds.motions.empty(), request);
  }
  std::vector<std::string> opened;
  std::copy_if(files.begin(), files.end(), std::back_inserter(opened), [&](const std::string& file) {
    return std::find(others.files.begin(), others.files.end(), file) == others.files.end();
  });
  load(std::move(attempts), std::move(opened));
  opened_.insert(opened_.end(), others.files.rbegin(), others.files.rend());
  return others;
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
  giveUp();
  loading_ = std::make_unique<BackgroundWork<Cast>>(
      host_, [attempts = std::move(attempts)](Host& host) { return prepareSettledCast(attempts, host); });
}

void WindowOpener::cancel() {
  cancelled_ = cancelled_ || loading_ != nullptr;
  giveUp();
}

void WindowOpener::giveUp() {
  if (loading_) loading_->abandon();
  loading_.reset();
}

std::optional<Result<Cast>> WindowOpener::take() {
  if (std::exchange(cancelled_, false)) return cancelled();
  if (!loading_) return std::nullopt;
  std::optional<Result<Cast>> result = loading_->take();
  if (!result) return result;
  loading_.reset();
  if (*result) {
    remember(**result);
    opened_.insert(opened_.end(), asked_.begin(), asked_.end());
  }
  return result;
}

void WindowOpener::describe(WindowValues& values) {
  values.hint = hint();
  if (whyNot_.empty()) {
    values.motions = motions_;
    const auto present = std::find(motions_.begin(), motions_.end(), present_.motion);
    values.motion = present == motions_.end() ? -1 : present - motions_.begin();
    values.clips = choices_.clips;
    values.clip = choices_.clip;
    values.people = choices_.people;
    values.person = choices_.person;
    values.everyone = choices_.everyone;
  }
  if (!loading_) return;
  progress_ = loading_->progress();
  values.loading = progress_.title();
  values.loaded = progress_.share;
}

}  // namespace lorica
