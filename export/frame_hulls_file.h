#pragma once

#include "collision/hulls/frame_hulls.h"

#include <filesystem>
#include <string>
#include <vector>

namespace lorica {

/// What was written, for reports.
struct WrittenFrames {
  int files = 0;
  int rigid = 0;  ///< parts of a .glb that a node moves; the others have morph targets
};

/// The files that writeFrameHulls() writes: of .obj one a frame, NAME_0001.obj and on; of .pc2 also the mesh beside it.
[[nodiscard]] std::vector<std::filesystem::path> filesOfFrames(const std::filesystem::path& file, std::size_t frames);

/// Refuses a name whose ending writeFrameHulls() does not know.
[[nodiscard]] Result<void> checkFrameFile(const std::filesystem::path& file);

/// Writes the hulls of all frames, completely or not at all, by the name's ending:
/// - .obj: a file a frame, an object `o part_0`, ... each, as writeObjObjects()
/// - .npz: `vertices` (all, 3) and `faces` (all, 3; of the vertices of its hull) of frame after frame, part after part;
///   `vertex_counts`, `face_counts` (frames, parts); `times`, `mesh_volumes`, `hull_volumes` (frames)
/// - .pc2 and .glb: for each part the points that are on its hull in any frame, with the triangles of the first frame's
///   hull: the convex hull of the points is that of the part in every frame. A .pc2 has an .obj beside it; in a .glb a
///   part whose points move rigidly, to 0.05 % of the mesh's diagonal, is moved by its node, others by morph targets
/// @param decomposition  that the hulls are of
[[nodiscard]] Result<WrittenFrames> writeFrameHulls(const std::filesystem::path& file, const FrameHulls& frames,
                                                    const Decomposition& decomposition);

/// The bytes of a table: frame, time, mesh and hull volume, error, score (Thul et al. 2018, Eq. 17).
[[nodiscard]] std::string formatFrameTable(const FrameHulls& frames);

}  // namespace lorica
