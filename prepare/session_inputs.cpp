#include "prepare/session_inputs.h"

#include <fmt/format.h>
#include "geometry/errors.h"

#include <filesystem>
#include <system_error>

namespace lorica {

namespace fs = std::filesystem;

bool isShippedName(const std::string& name) {
  return name.find('/') == std::string::npos && !fs::path(name).has_extension();
}

std::string nameFrom(const std::string& session, const std::string& file) {
  if (file.empty()) return file;
  std::error_code error;
  const fs::path folder = fs::path(session).has_parent_path() ? fs::path(session).parent_path() : fs::path(".");
  const fs::path relative = fs::relative(file, folder, error);
  return error || relative.empty() ? file : relative.string();
}

Result<SessionInputs> inputsOf(const SessionFile& recorded, const std::string& session, std::size_t avatar,
                               const std::string& character, const std::string& decomposition, const Host& host) {
  const AvatarRecord& header = recorded.header.avatar(avatar);
  const SessionHeader& whole = recorded.header;
  const NamedFiles nearby{fs::path(session).parent_path(), host.paths};
  Result<void> done;
  const auto find = [&](const std::string& name, const char* what, const char* instead) -> std::string {
    if (!done || name.empty()) return name;
    const Result<fs::path> file = nearby.find(name);
    std::error_code ignored;
    const fs::file_type type = file ? fs::status(*file, ignored).type() : fs::file_type::none;
    const bool special = type == fs::file_type::fifo || type == fs::file_type::socket;  // opening one may wait
    if (file && !special) return file->string();
    const std::string why = file ? fmt::format("{} is no regular file", file->string()) : file.error().message;
    done = badFormat("{}: the recorded {}: {}{}", session, what, why, instead);
    return {};
  };
  SessionInputs inputs;
  inputs.character = !character.empty() ? character
                     : isShippedName(header.character)
                         ? header.character
                         : find(header.character, "character", "; --character gives its file");
  inputs.boneMap = find(header.boneMap, "bone map", "");
  inputs.decomposition = decomposition.empty()
                             ? find(header.decomposition, "decomposition", "; --decomposition gives its file")
                             : decomposition;
  inputs.scene = {recorded.sceneText, {}, host.paths};
  if (isShippedName(whole.scene) && !whole.scene.empty()) {
    LORICA_TRY(inputs.scene.folder, scenesFolder());
  } else if (!whole.scene.empty()) {
    inputs.scene.folder = find(whole.sceneFolder.empty() ? "." : whole.sceneFolder, "folder of the scene", "");
  }
  if (!done) return done.error();
  return inputs;
}

Result<CharacterOptions> readingOf(const SessionInputs& inputs, const AvatarRecord& record) {
  CharacterOptions reading{inputs.boneMap, record.bodyResolution};
  reading.walls = wallChoiceNamed(record.walls);
  if (!reading.walls && !record.walls.empty()) {
    return invalidArgument("walls of the character: found {}, expected auto, solid or shell",
                           record.walls.substr(0, 40));
  }
  reading.thickness = record.thickness;
  reading.hidden = record.hidden;
  return reading;
}

}  // namespace lorica
