#include "prepare/file_kinds.h"

#include "geometry/errors.h"
#include "geometry/text.h"

#include <array>
#include <fstream>
#include <string>
#include <string_view>

namespace lorica {
namespace {

using namespace std::string_view_literals;

struct Kind {
  std::size_t at;  ///< of the mark in the file
  std::string_view mark;
  std::string_view name;
};
constexpr std::array kKinds = {
    Kind{0, "\x89PNG"sv, "a PNG picture"},      Kind{0, "\xff\xd8\xff"sv, "a JPEG picture"},
    Kind{0, "GIF8"sv, "a GIF picture"},         Kind{8, "WEBP"sv, "a WebP picture"},
    Kind{8, "AVI "sv, "an AVI film"},           Kind{8, "WAVE"sv, "a WAV sound"},
    Kind{4, "ftyp"sv, "a film (MP4)"},          Kind{0, "\x1a\x45\xdf\xa3"sv, "a film (Matroska)"},
    Kind{0, "OggS"sv, "a sound or film (Ogg)"}, Kind{0, "ID3"sv, "a sound (MP3)"},
    Kind{0, "%PDF"sv, "a PDF document"},        Kind{0, "PK\x03\x04"sv, "a ZIP archive"},
    Kind{0, "\x1f\x8b"sv, "a gzip archive"},    Kind{0, "Rar!"sv, "a RAR archive"},
    Kind{0, "7z\xbc\xaf"sv, "a 7z archive"},    Kind{0, "BLENDER"sv, "a Blender project: export it as .glb"},
    Kind{0, "\177ELF"sv, "a program"},          Kind{0, "MZ\x90"sv, "a program"},
};

/// Text that is for people, whatever it holds.
constexpr std::array kTexts = {".md"sv, ".html"sv, ".htm"sv, ".xml"sv, ".log"sv, ".py"sv, ".cpp"sv, ".h"sv};

}  // namespace

Result<void> refuseOtherKinds(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return {};
  std::array<char, 16> bytes{};
  std::ifstream in(file, std::ios::binary);
  in.read(bytes.data(), bytes.size());
  const std::string_view begin(bytes.data(), in.gcount());
  std::string_view found;
  for (const Kind& kind : kKinds) {
    if (begin.size() >= kind.at && begin.substr(kind.at).starts_with(kind.mark)) found = kind.name;
  }
  const std::string extension = lowerCase(file.extension().string());
  for (const std::string_view text : kTexts) {
    if (extension == text) found = "a text";
  }
  if (found.empty()) return {};
  return unsupported(
      "{}: found {}; Lorica opens characters (.glb, .gltf, .vrm, .vrma, .fbx, .dae), motions (.bvh, joints as .csv, "
      ".txt or .json), depth recordings (.oni), meshes (.obj, .ply, .stl, .off), scenes (.json), sessions (.lsession), "
      "packets "
      "(.pcap) and decompositions (.lorica)",
      file.string(), found);
}

bool isJointJson(const std::filesystem::path& file) {
  constexpr std::streamsize kBegin = 4096;
  if (lowerCase(file.extension().string()) != ".json") return false;
  std::string begin(kBegin, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(begin.data(), kBegin);
  begin.resize(in.gcount());
  const auto has = [&](std::string_view name) { return begin.find(name) != std::string::npos; };
  return !has("lorica scene") && (has("\"joint_positions\"") || has("\"joint_names\"") || has("\"frames\""));
}

}  // namespace lorica
