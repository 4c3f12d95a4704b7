#include "export/frame_hulls_file.h"

#include "geometry/arrays/array_file.h"
#include "geometry/errors.h"
#include "geometry/little_endian.h"
#include "geometry/mesh_files.h"
#include "geometry/text.h"
#include "skinning/clip_files/gltf_writer.h"

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kRigid = 5e-4;  // of the mesh's diagonal

std::string partName(std::size_t part) {
  return fmt::format("part_{}", part);
}

std::vector<NamedMesh> objectsOf(const std::vector<ConvexHull>& hulls) {
  std::vector<NamedMesh> objects;
  objects.reserve(hulls.size());
  for (const ConvexHull& hull : hulls) objects.push_back({partName(objects.size()), {hull.vertices, hull.triangles}});
  return objects;
}

/// A part in all frames, with the same points and triangles.
struct FixedPart {
  std::vector<PointIndex> points;  ///< of the decomposition, ascending
  std::vector<Triangle> triangles;

  [[nodiscard]] std::vector<Vec3> in(std::span<const Vec3> frame) const {
    std::vector<Vec3> positions;
    positions.reserve(points.size());
    for (const PointIndex p : points) positions.push_back(frame[p]);
    return positions;
  }
};

std::vector<FixedPart> fixedParts(const FrameHulls& frames, const Decomposition& decomposition) {
  std::vector<FixedPart> parts;
  for (std::size_t p = 0; p < decomposition.parts.size(); ++p) {
    const std::vector<PointIndex>& points = decomposition.parts[p].points;
    FixedPart& part = parts.emplace_back();
    std::vector<bool> used(points.size(), false);
    for (const std::vector<ConvexHull>& hulls : frames.hulls) {
      for (const VertexIndex v : hulls[p].pointOfVertex) used[v] = true;
    }
    std::vector<VertexIndex> number(points.size(), 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
      number[i] = static_cast<VertexIndex>(part.points.size());
      if (used[i]) part.points.push_back(points[i]);
    }
    const ConvexHull& first = frames.hulls.front()[p];
    for (const Triangle& t : first.triangles) {
      Triangle& mine = part.triangles.emplace_back();
      for (std::size_t c = 0; c < 3; ++c) mine[c] = number[first.pointOfVertex[t[c]]];
    }
  }
  return parts;
}

Result<void> writeObjFrames(const fs::path& file, const FrameHulls& frames) {
  const std::vector<fs::path> files = filesOfFrames(file, frames.hulls.size());
  for (std::size_t f = 0; f < files.size(); ++f) {
    Result<void> written = writeObjObjects(files[f], objectsOf(frames.hulls[f]));
    if (written) continue;
    std::error_code ignored;
    for (std::size_t before = 0; before < f; ++before) fs::remove(files[before], ignored);
    return written;
  }
  return {};
}

template <typename Number>
NamedArray arrayOf(const char* name, const char* type, std::vector<std::size_t> shape,
                   const std::vector<Number>& numbers) {
  NamedArray array{name, type, std::move(shape), {}};
  for (const Number number : numbers) appendLittleEndian(number, array.bytes);
  return array;
}

Result<void> writeNpz(const fs::path& path, const FrameHulls& frames) {
  std::vector<double> vertices, meshVolumes, hullVolumes;
  std::vector<std::int32_t> faces, vertexCounts, faceCounts;
  for (const std::vector<ConvexHull>& hulls : frames.hulls) {
    for (const ConvexHull& hull : hulls) {
      for (const Vec3& p : hull.vertices) vertices.insert(vertices.end(), p.begin(), p.end());
      for (const Triangle& t : hull.triangles) faces.insert(faces.end(), t.begin(), t.end());
      vertexCounts.push_back(countOf(hull.vertices));
      faceCounts.push_back(countOf(hull.triangles));
    }
  }
  for (const PoseError& error : frames.errors) {
    meshVolumes.push_back(error.meshVolume);
    hullVolumes.push_back(error.hullVolume);
  }
  const std::size_t count = frames.hulls.size(), parts = frames.hulls.front().size();
  const std::vector<NamedArray> arrays = {arrayOf("vertices", "<f8", {vertices.size() / 3, 3}, vertices),
                                          arrayOf("faces", "<i4", {faces.size() / 3, 3}, faces),
                                          arrayOf("vertex_counts", "<i4", {count, parts}, vertexCounts),
                                          arrayOf("face_counts", "<i4", {count, parts}, faceCounts),
                                          arrayOf("times", "<f8", {count}, frames.times),
                                          arrayOf("mesh_volumes", "<f8", {count}, meshVolumes),
                                          arrayOf("hull_volumes", "<f8", {count}, hullVolumes)};
  LORICA_TRY(const std::unique_ptr<NewFile> file, NewFile::create(path));
  LORICA_TRY_DO(writeArrays(arrays, *file));
  return file->finish();
}

Result<void> writePc2(const fs::path& file, const FrameHulls& frames, const std::vector<FixedPart>& parts) {
  std::vector<NamedMesh> objects;
  std::int32_t points = 0;
  for (const FixedPart& part : parts) {
    objects.push_back({partName(objects.size()), {part.in(frames.frame(0)), part.triangles}});
    points += countOf(part.points);
  }
  std::string bytes("POINTCACHE2\0", 12);
  appendLittleEndian(std::int32_t{1}, bytes);  // the version
  appendLittleEndian(points, bytes);
  for (const float number : {0.0f, 1.0f}) appendLittleEndian(number, bytes);  // the first frame, frames a sample
  appendLittleEndian(static_cast<std::int32_t>(frames.hulls.size()), bytes);
  for (std::size_t f = 0; f < frames.hulls.size(); ++f) {
    for (const FixedPart& part : parts) {
      for (const PointIndex p : part.points) {
        for (const double x : frames.frame(f)[p]) appendLittleEndian(static_cast<float>(x), bytes);
      }
    }
  }
  const fs::path mesh = filesOfFrames(file, frames.hulls.size()).front();
  LORICA_TRY_DO(writeObjObjects(mesh, objects));
  Result<void> written = writeFileAtomically(file, bytes);
  std::error_code ignored;
  if (!written) fs::remove(mesh, ignored);
  return written;
}

std::vector<float> floatsOf(std::span<const Vec3> positions) {
  std::vector<float> numbers;
  numbers.reserve(3 * positions.size());
  for (const Vec3& p : positions) {
    for (const double x : p) numbers.push_back(static_cast<float>(x));
  }
  return numbers;
}

/// The rigid motion of points in each frame from the first one, as numbers of glTF.
struct NodeMotion {
  std::vector<float> translations, rotations;
};

std::optional<NodeMotion> rigidMotion(const FixedPart& part, const FrameHulls& frames, double tolerance) {
  const auto matrixOf = [](const std::vector<Vec3>& points) {
    return Eigen::Map<const Eigen::Matrix3Xd>(points.front().data(), 3, std::ssize(points));
  };
  const std::vector<Vec3> first = part.in(frames.frame(0));
  NodeMotion motion;
  Quat last = Quat::Identity();
  for (std::size_t f = 0; f < frames.hulls.size(); ++f) {
    const std::vector<Vec3> here = part.in(frames.frame(f));
    const Eigen::Matrix4d fit = Eigen::umeyama(matrixOf(first), matrixOf(here), false);
    const Mat3 turn = fit.topLeftCorner<3, 3>();
    const Vec3 shift = fit.topRightCorner<3, 1>();
    for (std::size_t i = 0; i < first.size(); ++i) {
      if (!((turn * first[i] + shift - here[i]).norm() <= tolerance)) return std::nullopt;
    }
    Quat q(turn);
    q.normalize();
    if (q.dot(last) < 0.0) q.coeffs() = -q.coeffs();
    last = q;
    for (const double x : shift) motion.translations.push_back(static_cast<float>(x));
    for (const double x : q.coeffs()) motion.rotations.push_back(static_cast<float>(x));
  }
  return motion;
}

/// Adds an animation channel of a node.
void addChannel(Json& animation, int node, const char* path, int times, int values) {
  Json& samplers = animation["samplers"];
  animation["channels"].push_back({{"sampler", samplers.size()}, {"target", {{"node", node}, {"path", path}}}});
  samplers.push_back({{"input", times}, {"interpolation", "LINEAR"}, {"output", values}});
}

Result<int> writeGlb(const fs::path& file, const FrameHulls& frames, const std::vector<FixedPart>& parts) {
  const std::size_t count = frames.hulls.size();
  Aabb box;
  for (const FixedPart& part : parts) {
    for (const Vec3& p : part.in(frames.frame(0))) box.extend(p);
  }
  GltfWriter writer;
  writer.document["asset"] = {{"version", "2.0"}, {"generator", "Lorica"}};
  writer.document["scene"] = 0;
  writer.document["scenes"] = Json::array({{{"nodes", Json::array()}}});
  std::vector<float> seconds;
  for (const double time : frames.times) seconds.push_back(static_cast<float>(time));
  const bool moves = count > 1;
  const int times = moves ? writer.addNumbers(seconds, "SCALAR", true) : 0;
  int weights = -1, rigid = 0;  // accessor of the weights, which all parts share
  Json animation = {{"name", "frames"}, {"channels", Json::array()}, {"samplers", Json::array()}};
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const FixedPart& part = parts[p];
    const std::vector<Vec3> first = part.in(frames.frame(0));
    std::vector<std::uint32_t> corners;
    for (const Triangle& t : part.triangles) corners.insert(corners.end(), t.begin(), t.end());
    Json primitive;
    primitive["attributes"]["POSITION"] = writer.addNumbers(floatsOf(first), "VEC3", true);
    primitive["indices"] = writer.addNumbers(std::span<const std::uint32_t>(corners), "SCALAR");
    const std::optional<NodeMotion> motion = rigidMotion(part, frames, kRigid * box.diagonal());
    if (motion) ++rigid;
    for (std::size_t f = 1; f < count && !motion; ++f) {
      std::vector<Vec3> offsets = part.in(frames.frame(f));
      for (std::size_t i = 0; i < offsets.size(); ++i) offsets[i] -= first[i];
      primitive["targets"].push_back({{"POSITION", writer.addNumbers(floatsOf(offsets), "VEC3", true)}});
    }
    Json mesh = {{"name", partName(p)}};
    mesh["primitives"] = Json::array({std::move(primitive)});
    const int meshIndex = writer.add("meshes", std::move(mesh));
    const int node = writer.add("nodes", {{"name", partName(p)}, {"mesh", meshIndex}});
    writer.document["scenes"][0]["nodes"].push_back(node);
    if (!moves) continue;
    if (motion) {
      addChannel(animation, node, "translation", times, writer.addNumbers(motion->translations, "VEC3"));
      addChannel(animation, node, "rotation", times, writer.addNumbers(motion->rotations, "VEC4"));
      continue;
    }
    if (weights < 0) {
      std::vector<float> ofFrames(count * (count - 1), 0.0f);
      for (std::size_t f = 1; f < count; ++f) ofFrames[f * (count - 1) + f - 1] = 1.0f;
      weights = writer.addNumbers(ofFrames, "SCALAR");
    }
    addChannel(animation, node, "weights", times, weights);
  }
  if (moves) writer.add("animations", std::move(animation));
  LORICA_TRY(const std::string bytes, writer.glb(file.string()));
  LORICA_TRY_DO(writeFileAtomically(file, bytes));
  return rigid;
}

}  // namespace

std::vector<fs::path> filesOfFrames(const fs::path& file, std::size_t frames) {
  const std::string ending = lowerCase(file.extension().string());
  if (ending == ".pc2") return {fs::path(file).replace_extension(".obj"), file};
  if (ending != ".obj") return {file};
  std::vector<fs::path> files;
  for (std::size_t f = 1; f <= frames; ++f) {
    files.push_back(file.parent_path() / fmt::format("{}_{:04}{}", file.stem().string(), f, file.extension().string()));
  }
  return files;
}

Result<void> checkFrameFile(const fs::path& file) {
  const std::string ending = lowerCase(file.extension().string());
  for (const char* known : {".obj", ".npz", ".pc2", ".glb"}) {
    if (ending == known) return {};
  }
  return invalidArgument("{}: ends in '{}', expected .obj, .npz, .pc2 or .glb", file.string(),
                         file.extension().string());
}

Result<WrittenFrames> writeFrameHulls(const fs::path& file, const FrameHulls& frames,
                                      const Decomposition& decomposition) {
  const std::string ending = lowerCase(file.extension().string());
  WrittenFrames written{static_cast<int>(filesOfFrames(file, frames.hulls.size()).size()), 0};
  if (ending == ".obj") {
    LORICA_TRY_DO(writeObjFrames(file, frames));
  } else if (ending == ".npz") {
    LORICA_TRY_DO(writeNpz(file, frames));
  } else if (ending == ".pc2") {
    LORICA_TRY_DO(writePc2(file, frames, fixedParts(frames, decomposition)));
  } else {
    LORICA_TRY_DO(checkFrameFile(file));
    LORICA_TRY(written.rigid, writeGlb(file, frames, fixedParts(frames, decomposition)));
  }
  return written;
}

std::string formatFrameTable(const FrameHulls& frames) {
  std::string table = "frame,time,mesh_volume,hull_volume,error,score\n";
  for (std::size_t f = 0; f < frames.errors.size(); ++f) {
    const PoseError& error = frames.errors[f];
    table += fmt::format("{},{},{},{},{},{}\n", f, frames.times[f], error.meshVolume, error.hullVolume,
                         error.relative(), error.meshVolume / error.hullVolume);
  }
  return table;
}

}  // namespace lorica
