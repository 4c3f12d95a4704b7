#include "skinning/import/gltf_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace lorica {

namespace {

/// Triangles of a primitive's indices, with the winding of glTF 2.0, 3.7.2.1.
[[nodiscard]] std::vector<Triangle> trianglesOf(const std::vector<std::uint32_t>& indices, int mode,
                                                GltfMeshCounts& statistics) {
  std::vector<Triangle> triangles;
  const std::size_t count = indices.size();
  const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
    const Triangle t = {static_cast<VertexIndex>(indices[a]), static_cast<VertexIndex>(indices[b]),
                        static_cast<VertexIndex>(indices[c])};
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
      ++statistics.degenerate;
    } else {
      triangles.push_back(t);
    }
  };
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    triangles.reserve(count / 3);
    for (std::size_t i = 0; i + 2 < count; i += 3) add(i, i + 1, i + 2);
    statistics.leftOver += count % 3;
  } else {
    triangles.reserve(count < 2 ? 0 : count - 2);
    for (std::size_t i = 0; i + 2 < count; ++i) {
      if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
        add(i, i + 1 + i % 2, i + 2 - i % 2);
      } else {
        add(i + 1, i + 2, 0);
      }
    }
    if (count < 3) statistics.leftOver += count;
  }
  return triangles;
}

class PrimitiveReader {
 public:
  PrimitiveReader(const GltfDocument& document, GltfAccessors& accessors, const tinygltf::Primitive& primitive,
                  std::string who)
      : document_(document), accessors_(accessors), primitive_(primitive), who_(std::move(who)) {}

  [[nodiscard]] bool has(const std::string& attribute) const { return primitive_.attributes.contains(attribute); }

  [[nodiscard]] Result<void> read(std::span<const double> morphWeights, bool skinned, GltfMeshCounts& statistics) {
    Result<std::vector<double>> positions = accessors_.numbers(accessorOf("POSITION"), 3, who_ + ": POSITION");
    if (!positions) return positions.error();
    positions_ = std::move(*positions);
    vertexCount_ = positions_.size() / 3;
    if (Result<void> moved = applyMorphs(morphWeights); !moved) return moved;
    if (Result<void> read = readTriangles(statistics); !read) return read;
    if (triangles_.empty()) return {};
    if (Result<void> read = readLook(); !read) return read;
    if (skinned) return readWeights();
    return {};
  }

  /// The mesh with only the vertices that its triangles use: several primitives often share one long list of them.
  [[nodiscard]] FileMesh compacted() const {
    FileMesh mesh;
    std::vector<VertexIndex> newIndex(vertexCount_, -1);
    mesh.triangles = triangles_;
    for (Triangle& triangle : mesh.triangles) {
      for (VertexIndex& v : triangle) newIndex[v] = 0;
    }
    VertexIndex used = 0;
    for (VertexIndex& v : newIndex) {
      if (v == 0) v = used++;
    }
    for (Triangle& triangle : mesh.triangles) {
      for (VertexIndex& v : triangle) v = newIndex[v];
    }
    mesh.positions.reserve(used);
    for (std::size_t v = 0; v < vertexCount_; ++v) {
      if (newIndex[v] >= 0)
        mesh.positions.emplace_back(positions_[3 * v], positions_[3 * v + 1], positions_[3 * v + 2]);
    }
    compactLook(newIndex, mesh);
    if (!primitive_.targets.empty()) {
      mesh.sourceVertices.reserve(used);
      for (std::size_t v = 0; v < vertexCount_; ++v) {
        if (newIndex[v] >= 0) mesh.sourceVertices.push_back(static_cast<VertexIndex>(v));
      }
    }
    if (sets_.empty()) return mesh;
    mesh.weights.reserve(4 * sets_.size() * static_cast<std::size_t>(used));
    mesh.weightBegin.reserve(static_cast<std::size_t>(used) + 1);
    mesh.weightBegin.push_back(0);
    for (std::size_t v = 0; v < vertexCount_; ++v) {
      if (newIndex[v] < 0) continue;
      for (const auto& [joints, weights] : sets_) {
        for (std::size_t c = 4 * v; c < 4 * v + 4; ++c) mesh.weights.push_back({joints[c], weights[c]});
      }
      mesh.weightBegin.push_back(mesh.weights.size());
    }
    return mesh;
  }

 private:
  [[nodiscard]] int accessorOf(const std::string& attribute) const { return primitive_.attributes.at(attribute); }

  [[nodiscard]] Error badCount(const std::string& attribute, std::size_t count) const {
    return {ErrorCode::kBadFormat, fmt::format("{}: {}: {} has {} elements, expected {}, one for each position",
                                               document_.name, who_, attribute, grouped(count), grouped(vertexCount_))};
  }

  [[nodiscard]] Result<void> applyMorphs(std::span<const double> morphWeights) {
    for (std::size_t t = 0; t < std::min(morphWeights.size(), primitive_.targets.size()); ++t) {
      const auto offsetAccessor = primitive_.targets[t].find("POSITION");
      if (morphWeights[t] == 0.0 || offsetAccessor == primitive_.targets[t].end()) continue;
      const std::string what = fmt::format("POSITION of morph target {}", t);
      const Result<std::vector<double>> offsets =
          accessors_.numbers(offsetAccessor->second, 3, fmt::format("{}: {}", who_, what));
      if (!offsets) return offsets.error();
      if (offsets->size() != positions_.size()) return badCount(what, offsets->size() / 3);
      for (std::size_t i = 0; i < positions_.size(); ++i) positions_[i] += morphWeights[t] * (*offsets)[i];
    }
    return {};
  }

  [[nodiscard]] Result<void> readTriangles(GltfMeshCounts& statistics) {
    std::vector<std::uint32_t> indices;
    if (primitive_.indices == -1) {
      indices.resize(vertexCount_);
      for (std::size_t i = 0; i < vertexCount_; ++i) indices[i] = static_cast<std::uint32_t>(i);
    } else {
      Result<std::vector<std::uint32_t>> read = accessors_.integers(primitive_.indices, 1, who_ + ": indices");
      if (!read) return read.error();
      indices = std::move(*read);
    }
    for (std::size_t i = 0; i < indices.size(); ++i) {
      if (indices[i] < vertexCount_) continue;
      return Error{ErrorCode::kBadFormat,
                   fmt::format("{}: {}: index {} refers to vertex {}, but it has {}", document_.name, who_, grouped(i),
                               grouped(indices[i]), grouped(vertexCount_))};
    }
    triangles_ = trianglesOf(indices, primitive_.mode, statistics);
    return {};
  }

  [[nodiscard]] Result<void> readWeights() {
    for (int set = 0;; ++set) {
      const std::string jointsName = fmt::format("JOINTS_{}", set);
      const std::string weightsName = fmt::format("WEIGHTS_{}", set);
      if (!has(jointsName) || !has(weightsName)) return {};
      Result<std::vector<std::uint32_t>> joints =
          accessors_.integers(accessorOf(jointsName), 4, who_ + ": " + jointsName);
      if (!joints) return joints.error();
      if (joints->size() != 4 * vertexCount_) return badCount(jointsName, joints->size() / 4);
      Result<std::vector<double>> weights =
          accessors_.anyNumbers(accessorOf(weightsName), 4, who_ + ": " + weightsName);
      if (!weights) return weights.error();
      if (weights->size() != 4 * vertexCount_) return badCount(weightsName, weights->size() / 4);
      sets_.emplace_back(std::move(*joints), std::move(*weights));
    }
  }

  /// Normals, tangents, texture coordinates and colours; numbers that are not finite become 0.
  [[nodiscard]] Result<void> readLook() {
    const auto readInto = [&](const char* attribute, int components, std::vector<double>& out) -> Result<void> {
      if (!has(attribute)) return {};
      Result<std::vector<double>> numbers =
          accessors_.anyNumbers(accessorOf(attribute), components, fmt::format("{}: {}", who_, attribute));
      if (!numbers) return numbers.error();
      if (numbers->size() != static_cast<std::size_t>(components) * vertexCount_) {
        return badCount(attribute, numbers->size() / static_cast<std::size_t>(components));
      }
      for (double& number : *numbers) number = std::isfinite(number) ? number : 0.0;
      out = std::move(*numbers);
      return {};
    };
    if (Result<void> read = readInto("NORMAL", 3, normals_); !read) return read;
    if (Result<void> read = readInto("TANGENT", 4, tangents_); !read) return read;
    if (Result<void> read = readInto("TEXCOORD_0", 2, uv_[0]); !read) return read;
    if (Result<void> read = readInto("TEXCOORD_1", 2, uv_[1]); !read) return read;
    if (!has("COLOR_0")) return {};
    const auto accessor = static_cast<std::size_t>(accessorOf("COLOR_0"));
    const std::vector<tinygltf::Accessor>& all = document_.model.accessors;
    colorComponents_ = accessor < all.size() && all[accessor].type == TINYGLTF_TYPE_VEC3 ? 3 : 4;
    return readInto("COLOR_0", colorComponents_, colors_);
  }

  /// @param newIndex  for each vertex, its index in `mesh`, or -1
  void compactLook(const std::vector<VertexIndex>& newIndex, FileMesh& mesh) const {
    const auto at = [](const std::vector<double>& numbers, std::size_t i) { return static_cast<float>(numbers[i]); };
    for (std::size_t v = 0; v < vertexCount_; ++v) {
      if (newIndex[v] < 0) continue;
      if (!normals_.empty()) {
        mesh.normals.emplace_back(at(normals_, 3 * v), at(normals_, 3 * v + 1), at(normals_, 3 * v + 2));
      }
      if (!tangents_.empty()) {
        mesh.tangents.emplace_back(at(tangents_, 4 * v), at(tangents_, 4 * v + 1), at(tangents_, 4 * v + 2),
                                   at(tangents_, 4 * v + 3));
      }
      for (std::size_t set = 0; set < 2; ++set) {
        if (!uv_[set].empty()) mesh.uv[set].emplace_back(at(uv_[set], 2 * v), at(uv_[set], 2 * v + 1));
      }
      if (colors_.empty()) continue;
      const std::size_t c = static_cast<std::size_t>(colorComponents_) * v;
      mesh.colors.emplace_back(at(colors_, c), at(colors_, c + 1), at(colors_, c + 2),
                               colorComponents_ == 4 ? at(colors_, c + 3) : 1.0f);
    }
  }

  const GltfDocument& document_;
  GltfAccessors& accessors_;
  const tinygltf::Primitive& primitive_;
  std::string who_;
  std::size_t vertexCount_ = 0;
  std::vector<double> normals_, tangents_, colors_;
  std::array<std::vector<double>, 2> uv_;
  int colorComponents_ = 4;
  std::vector<double> positions_;
  std::vector<Triangle> triangles_;
  std::vector<std::pair<std::vector<std::uint32_t>, std::vector<double>>> sets_;
};

}  // namespace

Result<void> addGltfMesh(const GltfDocument& document, GltfAccessors& accessors, int meshIndex, int nodeIndex,
                         FileScene& scene, GltfMeshCounts& statistics) {
  const tinygltf::Node& node = document.model.nodes[nodeIndex];
  if (Result<void> known =
          checkIndex(document, meshIndex, document.model.meshes.size(), fmt::format("node {}", nodeIndex), "mesh");
      !known) {
    return known;
  }
  const tinygltf::Mesh& mesh = document.model.meshes[meshIndex];
  const std::span<const double> morphWeights = node.weights.empty() ? mesh.weights : node.weights;

  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    const tinygltf::Primitive& primitive = mesh.primitives[p];
    const std::string who =
        fmt::format("{}, primitive {}", titled("mesh", static_cast<std::size_t>(meshIndex), mesh.name), p);
    if (primitive.mode < TINYGLTF_MODE_POINTS || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
      return Error{ErrorCode::kBadFormat,
                   fmt::format("{}: {}: mode {}, expected 0 to 6", document.name, who, primitive.mode)};
    }
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
      ++statistics.pointsAndLines;
      continue;
    }
    PrimitiveReader reader(document, accessors, primitive, who);
    if (!reader.has("POSITION")) {
      ++statistics.withoutPositions;
      continue;
    }
    const bool skinned = node.skin != -1 && reader.has("JOINTS_0") && reader.has("WEIGHTS_0");
    if (node.skin != -1 && !skinned) ++statistics.rigidOnSkin;
    if (Result<void> read = reader.read(morphWeights, skinned, statistics); !read) return read;
    FileMesh made = reader.compacted();
    if (made.triangles.empty()) continue;
    made.name = mesh.name;
    made.node = nodeIndex;
    made.skin = skinned ? node.skin : -1;
    made.primitive = static_cast<int>(p);
    made.material = primitive.material;
    scene.meshes.push_back(std::move(made));
  }
  return {};
}

}  // namespace lorica
