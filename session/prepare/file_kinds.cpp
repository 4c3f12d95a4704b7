#include "session/prepare/file_kinds.h"

#include "capture/sensor/depth_recording.h"
#include "geometry/arrays/mesh_sequence.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "session/prepare/smpl.h"
#include "skinning/import/character_file.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>

namespace lorica {
namespace {

using namespace std::string_view_literals;

struct Ending {
  std::string_view name;
  FileKind kind;
};
constexpr std::array kEndings = {
    Ending{".bvh", FileKind::kBvh},
    Ending{".csv", FileKind::kJoints},
    Ending{".txt", FileKind::kJoints},
    Ending{".trc", FileKind::kJoints},
    Ending{".pcap", FileKind::kPackets},
    Ending{".lsession", FileKind::kSession},
    Ending{".off", FileKind::kMesh},
    Ending{".obj", FileKind::kMesh},
    Ending{".ply", FileKind::kMesh},
    Ending{".stl", FileKind::kMesh},
    Ending{".lorica", FileKind::kDecomposition},
};

struct Mark {
  std::size_t at;  ///< in the file
  std::string_view bytes;
  std::string_view what;
  bool opened = false;  ///< under another name
};
constexpr std::array kMarks = {
    Mark{0, "\x89PNG"sv, "a PNG picture"},
    Mark{0, "\xff\xd8\xff"sv, "a JPEG picture"},
    Mark{0, "GIF8"sv, "a GIF picture"},
    Mark{8, "WEBP"sv, "a WebP picture"},
    Mark{8, "AVI "sv, "an AVI film"},
    Mark{8, "WAVE"sv, "a WAV sound"},
    Mark{4, "ftyp"sv, "a film (MP4)"},
    Mark{0, "\x1a\x45\xdf\xa3"sv, "a film (Matroska)"},
    Mark{0, "OggS"sv, "a sound or film (Ogg)"},
    Mark{0, "ID3"sv, "a sound (MP3)"},
    Mark{0, "%PDF"sv, "a PDF document"},
    Mark{0, "PK\x03\x04"sv, "a ZIP archive"},
    Mark{0, "\x1f\x8b"sv, "a gzip archive"},
    Mark{0, "Rar!"sv, "a RAR archive"},
    Mark{0, "7z\xbc\xaf"sv, "a 7z archive"},
    Mark{0, "BLENDER"sv, "a Blender project: export it as .glb"},
    Mark{0, "\177ELF"sv, "a program"},
    Mark{0, "MZ\x90"sv, "a program"},
    Mark{0, "glTF"sv, "a character whose name does not end in .glb", true},
    Mark{0, "Kaydara FBX"sv, "a character whose name does not end in .fbx", true},
    Mark{0, "HIERARCHY"sv, "a motion whose name does not end in .bvh", true},
};

/// Of what can be read again: reading from a pipe would consume its data.
std::string beginOf(const std::filesystem::path& file) {
  constexpr std::streamsize kBegin = 4096;  // within which JSON files say what they are
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return {};
  std::string begin(kBegin, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(begin.data(), kBegin);
  begin.resize(std::max<std::streamsize>(in.gcount(), 0));
  return begin;
}

}  // namespace

FileKind kindOf(const std::filesystem::path& file) {
  if (isCharacterFile(file)) return FileKind::kCharacter;
  const std::string extension = lowerCase(file.extension().string());
  if (extension == ".npz" && archiveKindOf(file) == ArchiveKind::kSmplMotion) return FileKind::kBodyModel;
  if (isDepthRecording(file)) return FileKind::kDepth;
  if (namesSequence(file.string())) return FileKind::kCharacter;
  for (const Ending& ending : kEndings) {
    if (extension == ending.name) return ending.kind;
  }
  const std::string begin = beginOf(file);
  const auto has = [&](std::string_view text) { return begin.find(text) != std::string::npos; };
  if (extension == ".json" && has("lorica scene")) return FileKind::kScene;
  if (extension == ".json" && (has("\"joint_positions\"") || has("\"joint_names\"") || has("\"frames\"") ||
                               has("andmarks\"") || has("\"visibility\""))) {
    return FileKind::kJoints;
  }
  return FileKind::kUnknown;
}

Result<void> refuseOtherKinds(const std::filesystem::path& file) {
  if (namesSequence(file.string())) return {};  // whose readers say more
  if (lowerCase(file.extension().string()) == ".pkl") {
    return withWhatOpens(
        unsupported("{}: a pickle runs code when it is opened, so it is not: save its arrays by numpy.savez as .npz",
                    file.string()));
  }
  const std::string begin = beginOf(file);
  const FileKind kind = kindOf(file);
  if (kind == FileKind::kUnknown && (begin.find("<robot") != begin.npos || begin.find("<mujoco") != begin.npos)) {
    return unsupported("{}: found a robot's description, whose meshes get hulls by `lorica export IN OUT`",
                       file.string());
  }
  if (kind == FileKind::kDepth) return {};  // whose readers say more
  const bool unnamed = kind == FileKind::kJoints || kind == FileKind::kUnknown;
  for (const Mark& mark : kMarks) {
    const bool found = begin.size() >= mark.at && std::string_view(begin).substr(mark.at).starts_with(mark.bytes);
    if (!found || (mark.opened && !unnamed)) continue;
    return withWhatOpens(unsupported("{}: found {}", file.string(), mark.what));
  }
  return {};
}

Error withWhatOpens(Error found) {
  found.message +=
      "; Lorica opens characters (.glb, .gltf, .vrm, .vrma, .fbx, .dae), mesh sequences (a folder, .npz, .pc2, .mdd), "
      "motions (.bvh, joints as .csv, .txt, .trc or .json), depth recordings (.oni, .mkv, .bag, .npz, a folder of "
      "PNG), meshes (.obj, .ply, .stl, .off), "
      "scenes (.json), sessions (.lsession), packets (.pcap) and decompositions (.lorica)";
  return found;
}

}  // namespace lorica
