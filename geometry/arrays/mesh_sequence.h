#pragma once

#include "geometry/counts.h"
#include "geometry/result.h"
#include "geometry/tri_mesh.h"

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

/// Meshes in several poses from files: a mesh a file, point caches, arrays of numpy. Internal: not installed.
namespace lorica {

/// One mesh in several poses. Lengths are in the unit of its files.
struct MeshSequence {
  std::string name;  ///< of the folder, the pattern or the file, without its folder
  std::vector<Triangle> triangles;
  std::vector<Vec3> positions;     ///< frameCount x vertexCount, frame-major
  int vertexCount = 0;             ///< in each frame
  double framesPerSecond = 30.0;   ///< as its file says, else 30
  std::vector<std::string> files;  ///< of each frame, without the folder; empty if one file has them all
  std::vector<std::string> notes;  ///< what was mended: a sentence each

  [[nodiscard]] int frameCount() const { return vertexCount == 0 ? 0 : countOf(positions) / vertexCount; }
  /// The vertices of a frame.
  [[nodiscard]] std::span<const Vec3> frame(int index) const {
    return std::span(positions).subspan(static_cast<std::size_t>(index) * vertexCount, vertexCount);
  }
};

/// Gets how many files are read; returns false to stop with kCancelled.
using SequenceProgress = std::function<bool(int done, int files)>;

/// Whether an input is a sequence by its name: a folder, a pattern such as "frames/*.obj", or a file that ends in .npz,
/// .npy, .pc2, .mdd, .abc, .usd, .usda, .usdc or .usdz.
[[nodiscard]] bool namesSequence(const std::string& input);

/// Whether a file's name comes before another one: numbers count as numbers, "frame_9" is before "frame_10".
[[nodiscard]] bool comesBefore(const std::string& a, const std::string& b);

/// The files of a folder or pattern, in the order of their names, in which numbers count as numbers.
/// @return at least one, all of one format
[[nodiscard]] Result<std::vector<std::filesystem::path>> meshesOf(const std::string& input);

/// Reads a sequence:
/// - a folder or a pattern: meshes (.obj, .off, .ply, .stl), see meshesOf()
/// - .npz: an array (frames, points, 3) and one of triangles (count, 3); `fps` if it is there
/// - .pc2 (Blender, 3ds Max), .mdd (LightWave) or .npy: points of all frames, of the mesh beside it with the same name
/// The frames must have the same triangles; where only the order of points or triangles differs, that is mended. Points
/// that are equal in every frame become one, if that closes edges.
/// @return or a sentence: of .abc and .usd, how Blender makes one of these of them
[[nodiscard]] Result<MeshSequence> readMeshSequence(const std::string& input, const SequenceProgress& progress = {});

/// The same of files that are named one by one, a frame each. @param name  of the sequence
[[nodiscard]] Result<MeshSequence> readMeshSequence(const std::string& name,
                                                    std::span<const std::filesystem::path> frames,
                                                    const SequenceProgress& progress = {});

/// Checks numbers, indices and counts, and makes points that are equal in every frame one, if that closes edges.
[[nodiscard]] Result<MeshSequence> checkedSequence(MeshSequence sequence);

}  // namespace lorica
