#include "skinning/import/character_file.h"

#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/interrupt.h"
#include "geometry/text.h"
#include "skinning/import/file_scene.h"
#include "skinning/import/isolated_scene.h"
#include "skinning/import/scene_readers.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace lorica {

namespace {

enum class FileKind { kUnknown, kGltf, kFbx, kCollada };

/// Detected from the content: the extensions .vrm and .glb are often wrong.
[[nodiscard]] FileKind kindOf(std::string_view content) {
  if (content.starts_with("glTF")) return FileKind::kGltf;
  if (content.starts_with("Kaydara FBX Binary")) return FileKind::kFbx;
  const std::string_view start = content.substr(0, 4096);
  const std::size_t first = start.find_first_not_of("\xEF\xBB\xBF \t\r\n");
  if (first == std::string_view::npos) return FileKind::kUnknown;
  if (start[first] == '{') return FileKind::kGltf;
  if (start[first] == '<' && start.find("<COLLADA") != std::string_view::npos) return FileKind::kCollada;
  const bool comment = start[first] == ';' && start.find("FBX") != std::string_view::npos;
  if (comment || start.substr(first).starts_with("FBXHeaderExtension")) return FileKind::kFbx;
  return FileKind::kUnknown;
}

/// FBX or COLLADA, in this process or in another one.
[[nodiscard]] Result<FileScene> readForeignScene(std::span<const std::byte> bytes, const std::string& name,
                                                 AssimpFormat format, const NamedFiles& files,
                                                 const CharacterFileSettings& settings) {
  Result<FileScene> scene = settings.isolated ? readIsolatedScene(bytes, name, format, files, *settings.isolated)
                                              : readAssimpScene(bytes, name, format, files);
  if (scene) readExpressions(nlohmann::json::object(), *scene);
  return scene;
}

[[nodiscard]] Result<CharacterFile> parse(std::span<const std::byte> bytes, const std::string& name,
                                          const std::filesystem::path& folder, const CharacterFileSettings& settings) {
  const NamedFiles files{folder, settings.paths};
  if (bytes.empty()) return badFormat(name + ": is empty, expected a character");
  std::string text;
  if (isUtf16({reinterpret_cast<const char*>(bytes.data()), bytes.size()})) {
    text = asUtf8({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    bytes = std::as_bytes(std::span(text));
  }
  Result<FileScene> scene = unsupported(name + ": unknown format, expected glTF, VRM, FBX or COLLADA");
  switch (kindOf({reinterpret_cast<const char*>(bytes.data()), bytes.size()})) {
    case FileKind::kGltf:
      scene = readGltfScene(bytes, name, files);
      break;
    case FileKind::kFbx:
      scene = readForeignScene(bytes, name, AssimpFormat::kFbx, files, settings);
      break;
    case FileKind::kCollada:
      scene = readForeignScene(bytes, name, AssimpFormat::kCollada, files, settings);
      break;
    case FileKind::kUnknown:
      break;
  }
  scene = unlessStopped(std::move(scene));
  if (!scene) return scene.error();
  LORICA_TRY_DO(checkWork(*scene, name));
  return makeCharacterFile(std::move(*scene), name, settings);
}

/// Errors quote names from the file, which may be long and contain anything.
[[nodiscard]] Result<CharacterFile> inOneLine(Result<CharacterFile> file) {
  if (file) return file;
  return Error{file.error().code, printable(file.error().message)};
}

}  // namespace

Result<CharacterFile> readCharacterFile(const std::filesystem::path& file, const CharacterFileSettings& settings) {
  LORICA_TRY(const std::string content, readFile(file));
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  return inOneLine(parse(std::as_bytes(std::span(content)), file.string(), folder, settings));
}

Result<CharacterFile> parseCharacterFile(std::span<const std::byte> bytes, const std::string& name,
                                         const CharacterFileSettings& settings) {
  return inOneLine(parse(bytes, name, {}, settings));
}

bool isCharacterFile(const std::filesystem::path& file) {
  const std::string extension = lowerCase(file.extension().string());
  constexpr std::array<std::string_view, 6> kExtensions = {".gltf", ".glb", ".vrm", ".vrma", ".fbx", ".dae"};
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

}  // namespace lorica
