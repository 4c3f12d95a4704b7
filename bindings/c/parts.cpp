#include "bindings/c/guard.h"
#include "bindings/c/handles.h"
#include "geometry/errors.h"
#include "geometry/work_budgets.h"

#include <algorithm>
#include <utility>

namespace lorica {
namespace {

constexpr int kUsualParts = 16;

thread_local std::string gLastError;

lorica_status statusOf(ErrorCode code) {
  constexpr lorica_status kOf[] = {// in the order of ErrorCode
                                   LORICA_NOT_FOUND,   LORICA_UNREADABLE,  LORICA_UNWRITABLE,
                                   LORICA_BAD_FORMAT,  LORICA_BAD_MESH,    LORICA_INVALID_ARGUMENT,
                                   LORICA_UNSUPPORTED, LORICA_UNSUPPORTED, LORICA_CANCELLED};
  return kOf[static_cast<std::size_t>(code)];
}

Result<MeshPartsSettings> settingsFrom(const lorica_decompose_options* given) {
  LORICA_TRY(const lorica_decompose_options options, taken(given, "options"));
  LORICA_TRY_DO(checkChoice(options.preset, LORICA_QUALITY, "preset"));
  LORICA_TRY_DO(checkChoice(options.closed_body, LORICA_CLOSED_ALWAYS, "closed_body"));
  LORICA_TRY_DO(checkChoice(options.walls, LORICA_WALLS_SHELL, "walls"));
  if (options.parts < -1) return invalidArgument("parts: found {}, expected -1 or more", options.parts);
  constexpr DecomposePreset kPresets[] = {DecomposePreset::kFast, DecomposePreset::kPaper, DecomposePreset::kQuality};
  constexpr BodyChoice kChoices[] = {BodyChoice::kIfNeeded, BodyChoice::kNever, BodyChoice::kAlways};
  constexpr WallChoice kWalls[] = {WallChoice::kByReach, WallChoice::kSolid, WallChoice::kShell};
  const bool limited = options.max_error > 0.0 || options.max_distance > 0.0 || options.max_concavity > 0.0;
  MeshPartsSettings settings;
  settings.decompose.maxParts = options.parts > 0 ? options.parts : options.parts == 0 && !limited ? kUsualParts : 0;
  settings.decompose.preset = kPresets[options.preset];
  settings.decompose.maxError = options.max_error;
  settings.decompose.maxDistance = options.max_distance;
  settings.decompose.threads = options.threads;
  settings.decompose.progress = progressFrom(options.progress, options.user);
  settings.hullVertices = options.hull_vertices;
  settings.hullPlanes = options.hull_planes;
  settings.closed = kChoices[options.closed_body];
  settings.maxConcavity = options.max_concavity;
  settings.thickness = options.thickness;
  settings.walls = kWalls[options.walls];
  if (options.keyframes < 0) return invalidArgument("keyframes: found {}, expected 0 or more", options.keyframes);
  settings.keyframes = options.keyframes;
  return settings;
}

Result<MeshSequence> meshFrom(const lorica_mesh* given) {
  LORICA_TRY_DO(lorica::given(given, "mesh"));
  LORICA_TRY(const lorica_mesh mesh, taken(given, "mesh"));
  if ((mesh.vertices == nullptr && mesh.vertex_count > 0) || (mesh.triangles == nullptr && mesh.triangle_count > 0)) {
    return invalidArgument("mesh: vertices or triangles are null, and their count is not 0");
  }
  const std::vector<std::int64_t> corners(mesh.triangles, mesh.triangles + 3 * mesh.triangle_count);
  const std::size_t frames = std::max<std::size_t>(mesh.frame_count, 1);
  if (mesh.vertex_count > kMaxSequencePoints / frames && frames > 1) {
    return unsupported("mesh: {} frames of {} vertices, expected at most {} in all", frames, mesh.vertex_count,
                       kMaxSequencePoints);
  }
  return checkedMesh({mesh.vertices, 3 * frames * mesh.vertex_count}, mesh.vertex_count, corners);
}

/// The common part of decomposing and loading. @param make  from a mesh and settings
template <typename Make>
lorica_status makeParts(const lorica_mesh* mesh, const lorica_decompose_options* options, lorica_parts** out,
                        const Make& make) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(out, "out"));
    LORICA_TRY(const MeshPartsSettings settings, settingsFrom(options));
    LORICA_TRY(MeshSequence checked, meshFrom(mesh));
    LORICA_TRY(MeshParts made, make(std::move(checked), settings));
    *out = new lorica_parts{std::move(made)};
    return {};
  });
}

}  // namespace

lorica_status fail(const Error& error) noexcept {
  try {
    gLastError = error.message;
  } catch (...) {
    gLastError.clear();
  }
  return statusOf(error.code);
}

DecomposeProgress progressFrom(lorica_progress progress, void* user) {
  if (progress == nullptr) return {};
  return [=](int done, int wanted) { return progress(user, done, wanted) != 0; };
}

Result<void> handOut(const DecompositionFile& content, void* bytes, std::size_t room, std::size_t* count) {
  LORICA_TRY_DO(given(count, "count"));
  LORICA_TRY(const std::string file, formatDecomposition(content, "bytes"));
  *count = file.size();
  if (bytes == nullptr) return {};
  if (room < file.size()) return invalidArgument("room: found {} bytes, expected {}", room, file.size());
  std::memcpy(bytes, file.data(), file.size());
  return {};
}

Result<void> handOut(const ConvexHull& hull, lorica_hull* out) {
  lorica_hull whole = {};
  whole.vertices = hull.vertices.empty() ? nullptr : hull.vertices.front().data();
  whole.vertex_count = hull.vertices.size();
  whole.triangles = hull.triangles.empty() ? nullptr : hull.triangles.front().data();
  whole.triangle_count = hull.triangles.size();
  whole.volume = hull.volume;
  return handOut(whole, out);
}

}  // namespace lorica

using namespace lorica;

const char* lorica_version(void) {
  return LORICA_VERSION;
}

const char* lorica_last_error(void) {
  return gLastError.c_str();
}

lorica_status lorica_decompose(const lorica_mesh* mesh, const lorica_decompose_options* options, lorica_parts** out) {
  return makeParts(mesh, options, out, [](MeshSequence checked, const MeshPartsSettings& settings) {
    return partsOfMesh(std::move(checked), settings);
  });
}

lorica_status lorica_parts_load(const char* file, const lorica_mesh* mesh, const lorica_decompose_options* options,
                                lorica_parts** out) {
  return makeParts(mesh, options, out,
                   [&](MeshSequence checked, const MeshPartsSettings& settings) -> Result<MeshParts> {
                     LORICA_TRY_DO(given(file, "file"));
                     LORICA_TRY(const EarlierParts earlier, earlierPartsIn(file));
                     return partsAsBefore(earlier, std::move(checked), settings);
                   });
}

lorica_status lorica_parts_save(const lorica_parts* parts, const char* file) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(parts, "parts", file, "file"));
    return writeDecomposition(file, parts->parts.content);
  });
}

lorica_status lorica_parts_from_bytes(const void* bytes, size_t count, const lorica_mesh* mesh,
                                      const lorica_decompose_options* options, lorica_parts** out) {
  return makeParts(
      mesh, options, out, [&](MeshSequence checked, const MeshPartsSettings& settings) -> Result<MeshParts> {
        LORICA_TRY_DO(given(bytes, "bytes"));
        LORICA_TRY(DecompositionFile content, parseDecomposition({static_cast<const char*>(bytes), count}, "bytes"));
        return partsAsBefore({"bytes", std::move(content)}, std::move(checked), settings);
      });
}

lorica_status lorica_parts_bytes(const lorica_parts* parts, void* bytes, size_t room, size_t* count) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(parts, "parts"));
    return handOut(parts->parts.content, bytes, room, count);
  });
}

void lorica_parts_free(lorica_parts* parts) {
  delete parts;
}

size_t lorica_parts_count(const lorica_parts* parts) {
  return parts == nullptr ? 0 : parts->parts.hulls().size();
}

size_t lorica_parts_frame_count(const lorica_parts* parts) {
  return parts == nullptr ? 0 : parts->parts.frames.size();
}

lorica_status lorica_parts_hull(const lorica_parts* parts, size_t part, lorica_hull* out) {
  return lorica_parts_hull_in_frame(parts, 0, part, out);
}

lorica_status lorica_parts_hull_in_frame(const lorica_parts* parts, size_t frame, size_t part, lorica_hull* out) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(parts, "parts"));
    LORICA_TRY_DO(inRange(frame, parts->parts.frames.size(), "frame"));
    LORICA_TRY_DO(inRange(part, parts->parts.hulls().size(), "part"));
    return handOut(parts->parts.frames[frame][part], out);
  });
}

double lorica_parts_mesh_volume(const lorica_parts* parts) {
  return parts == nullptr ? 0.0 : parts->parts.errors.front().meshVolume;
}

double lorica_parts_hull_volume(const lorica_parts* parts) {
  return parts == nullptr ? 0.0 : parts->parts.errors.front().hullVolume;
}

double lorica_parts_error(const lorica_parts* parts) {
  return parts == nullptr ? 0.0 : parts->parts.meanError();
}

double lorica_parts_error_in_frame(const lorica_parts* parts, size_t frame) {
  return parts == nullptr || frame >= parts->parts.errors.size() ? 0.0 : parts->parts.errors[frame].relative();
}

uint64_t lorica_parts_hash(const lorica_parts* parts) {
  return parts == nullptr ? 0 : hashOf(parts->parts.content.decomposition);
}

const char* lorica_parts_repaired(const lorica_parts* parts) {
  return parts == nullptr ? "" : parts->parts.repaired.c_str();
}

const char* lorica_parts_warning(const lorica_parts* parts) {
  return parts == nullptr ? "" : parts->parts.warning.c_str();
}
