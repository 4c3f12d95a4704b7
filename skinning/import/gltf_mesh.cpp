#include "skinning/import/gltf_parts.h"

#include "geometry/counts.h"
#include "geometry/errors.h"

#include <fmt/format.h>

#include <algorithm>
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
    if (hasRepeatedCorner(t)) {
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
  PrimitiveReader(const GltfMeshSources& sources, const tinygltf::Primitive& primitive, std::string who)
      : document_(sources.document),
        accessors_(sources.accessors),
        lookAccessors_(sources.lookAccessors),
        primitive_(primitive),
        who_(std::move(who)) {}

  [[nodiscard]] bool has(const std::string& attribute) const { return primitive_.attributes.contains(attribute); }

  [[nodiscard]] Result<void> read(std::span<const double> morphWeights, bool skinned, GltfMeshCounts& statistics) {
    LORICA_TRY(std::vector<double> positions, accessors_.numbers(accessorOf("POSITION"), 3, who_ + ": POSITION"));
    positions_ = std::move(positions);
    vertexCount_ = positions_.size() / 3;
    LORICA_TRY_DO(applyMorphs(morphWeights));
    LORICA_TRY_DO(readTriangles(statistics));
    if (triangles_.empty()) return {};
    if (skinned) return readWeights();
    return {};
  }

  /// The mesh with only the vertices that its triangles use: several primitives often share one long list of them.
  /// Ends the reader.
  [[nodiscard]] FileMesh compacted() {
    FileMesh mesh;
    mesh.triangles = std::move(triangles_);
    newIndex_.assign(vertexCount_, -1);
    for (Triangle& triangle : mesh.triangles) {
      for (VertexIndex& v : triangle) newIndex_[v] = 0;
    }
    VertexIndex used = 0;
    for (VertexIndex& v : newIndex_) {
      if (v == 0) v = used++;
    }
    for (Triangle& triangle : mesh.triangles) {
      for (VertexIndex& v : triangle) v = newIndex_[v];
    }
    mesh.positions.reserve(used);
    for (std::size_t v = 0; v < vertexCount_; ++v) {
      if (newIndex_[v] >= 0) {
        mesh.positions.emplace_back(positions_[3 * v], positions_[3 * v + 1], positions_[3 * v + 2]);
      }
    }
    std::vector<double>().swap(positions_);
    if (!primitive_.targets.empty()) {
      mesh.sourceVertices.reserve(used);
      for (std::size_t v = 0; v < vertexCount_; ++v) {
        if (newIndex_[v] >= 0) mesh.sourceVertices.push_back(v);
      }
    }
    if (sets_.empty()) return mesh;
    mesh.weights.reserve(4 * sets_.size() * used);
    mesh.weightBegin.reserve(used + 1);
    mesh.weightBegin.push_back(0);
    for (std::size_t v = 0; v < vertexCount_; ++v) {
      if (newIndex_[v] < 0) continue;
      for (const auto& [joints, weights] : sets_) {
        for (std::size_t c = 4 * v; c < 4 * v + 4; ++c) mesh.weights.push_back({joints[c], weights[c]});
      }
      mesh.weightBegin.push_back(mesh.weights.size());
    }
    return mesh;
  }

  /// Adds normals, tangents, texture coordinates and colours to the compacted mesh; numbers that are not finite become
  /// 0. What is broken is left out, with a note.
  void readLook(const LookNeeds& needs, FileMesh& mesh, GltfMeshCounts& statistics, CountedNotes& notes) {
    const auto readInto = [&](const std::string& attribute, int components, auto& out) {
      if (!has(attribute)) return;
      Result<std::vector<double>> numbers =
          lookAccessors_.anyNumbers(accessorOf(attribute), components, fmt::format("{}: {}", who_, attribute));
      if (numbers && numbers->size() != components * vertexCount_) {
        numbers = badCount(attribute, numbers->size() / components);
      }
      if (!numbers) {
        const std::string problem = numbers.error().message.substr(document_.name.size() + 2);
        notes.add("lists of normals, tangents, texture coordinates or colours are broken: not used",
                  fmt::format("{}: {} is not used: {}", who_, attribute, problem));
        return;
      }
      out.reserve(mesh.positions.size());
      for (std::size_t v = 0; v < vertexCount_; ++v) {
        if (newIndex_[v] < 0) continue;
        auto& to = out.emplace_back();
        to.setOnes();  // the opacity of colours without one
        for (int c = 0; c < components; ++c) {
          const auto number = static_cast<float>((*numbers)[components * v + c]);
          const bool finite = std::isfinite(number);
          to[c] = finite ? number : 0.0f;
          if (!finite) ++statistics.notFinite;
        }
      }
    };
    readInto("NORMAL", 3, mesh.normals);
    if (needs.tangents) readInto("TANGENT", 4, mesh.tangents);
    for (std::size_t set = 0; set < 2; ++set) {
      if (needs.uv[set]) readInto(fmt::format("TEXCOORD_{}", set), 2, mesh.uv[set]);
    }
    if (!needs.colors || !has("COLOR_0")) return;
    const std::size_t accessor = accessorOf("COLOR_0");
    const std::vector<tinygltf::Accessor>& all = document_.model.accessors;
    const bool opaque = accessor < all.size() && all[accessor].type == TINYGLTF_TYPE_VEC3;
    readInto("COLOR_0", opaque ? 3 : 4, mesh.colors);
  }

 private:
  [[nodiscard]] int accessorOf(const std::string& attribute) const { return primitive_.attributes.at(attribute); }

  [[nodiscard]] Error badCount(const std::string& attribute, std::size_t count) const {
    return badFormat("{}: {}: {} has {} elements, expected {}, one for each position", document_.name, who_, attribute,
                     grouped(count), grouped(vertexCount_));
  }

  [[nodiscard]] Result<void> applyMorphs(std::span<const double> morphWeights) {
    for (std::size_t t = 0; t < std::min(morphWeights.size(), primitive_.targets.size()); ++t) {
      const auto offsetAccessor = primitive_.targets[t].find("POSITION");
      if (morphWeights[t] == 0.0 || offsetAccessor == primitive_.targets[t].end()) continue;
      const std::string what = fmt::format("POSITION of morph target {}", t);
      LORICA_TRY(const std::vector<double> offsets,
                 accessors_.numbers(offsetAccessor->second, 3, fmt::format("{}: {}", who_, what)));
      if (offsets.size() != positions_.size()) return badCount(what, offsets.size() / 3);
      for (std::size_t i = 0; i < positions_.size(); ++i) positions_[i] += morphWeights[t] * offsets[i];
    }
    return {};
  }

  [[nodiscard]] Result<void> readTriangles(GltfMeshCounts& statistics) {
    std::vector<std::uint32_t> indices;
    if (primitive_.indices == -1) {
      indices.resize(vertexCount_);
      for (std::size_t i = 0; i < vertexCount_; ++i) indices[i] = i;
    } else {
      LORICA_TRY(std::vector<std::uint32_t> read, accessors_.integers(primitive_.indices, 1, who_ + ": indices"));
      indices = std::move(read);
    }
    for (std::size_t i = 0; i < indices.size(); ++i) {
      if (indices[i] < vertexCount_) continue;
      return badFormat("{}: {}: index {} refers to vertex {}, but it has {}", document_.name, who_, grouped(i),
                       grouped(indices[i]), grouped(vertexCount_));
    }
    triangles_ = trianglesOf(indices, primitive_.mode, statistics);
    return {};
  }

  [[nodiscard]] Result<void> readWeights() {
    for (int set = 0;; ++set) {
      const std::string jointsName = fmt::format("JOINTS_{}", set);
      const std::string weightsName = fmt::format("WEIGHTS_{}", set);
      if (!has(jointsName) || !has(weightsName)) return {};
      LORICA_TRY(std::vector<std::uint32_t> joints,
                 accessors_.integers(accessorOf(jointsName), 4, who_ + ": " + jointsName));
      if (joints.size() != 4 * vertexCount_) return badCount(jointsName, joints.size() / 4);
      LORICA_TRY(std::vector<double> weights,
                 accessors_.anyNumbers(accessorOf(weightsName), 4, who_ + ": " + weightsName));
      if (weights.size() != 4 * vertexCount_) return badCount(weightsName, weights.size() / 4);
      sets_.emplace_back(std::move(joints), std::move(weights));
    }
  }

  const GltfDocument& document_;
  GltfAccessors& accessors_;
  GltfAccessors& lookAccessors_;
  const tinygltf::Primitive& primitive_;
  std::string who_;
  std::size_t vertexCount_ = 0;
  std::vector<double> positions_;
  std::vector<VertexIndex> newIndex_;  // in the compacted mesh, or -1
  std::vector<Triangle> triangles_;
  std::vector<std::pair<std::vector<std::uint32_t>, std::vector<double>>> sets_;
};

}  // namespace

Result<void> addGltfMesh(const GltfMeshSources& sources, int meshIndex, int nodeIndex, FileScene& scene,
                         GltfMeshCounts& statistics, CountedNotes& notes) {
  const GltfDocument& document = sources.document;
  const tinygltf::Node& node = document.model.nodes[nodeIndex];
  LORICA_TRY_DO(
      checkIndex(document, meshIndex, document.model.meshes.size(), fmt::format("node {}", nodeIndex), "mesh"));
  const tinygltf::Mesh& mesh = document.model.meshes[meshIndex];
  const std::span<const double> morphWeights = node.weights.empty() ? mesh.weights : node.weights;

  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    const tinygltf::Primitive& primitive = mesh.primitives[p];
    const std::string who = fmt::format("{}, primitive {}", titled("mesh", meshIndex, mesh.name), p);
    if (primitive.mode < TINYGLTF_MODE_POINTS || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
      return badFormat("{}: {}: mode {}, expected 0 to 6", document.name, who, primitive.mode);
    }
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
      ++statistics.pointsAndLines;
      continue;
    }
    PrimitiveReader reader(sources, primitive, who);
    if (!reader.has("POSITION")) {
      ++statistics.withoutPositions;
      continue;
    }
    const bool skinned = node.skin != -1 && reader.has("JOINTS_0") && reader.has("WEIGHTS_0");
    if (node.skin != -1 && !skinned) ++statistics.rigidOnSkin;
    LORICA_TRY_DO(reader.read(morphWeights, skinned, statistics));
    FileMesh made = reader.compacted();
    if (made.triangles.empty()) continue;
    made.name = mesh.name;
    made.node = nodeIndex;
    made.skin = skinned ? node.skin : -1;
    made.primitive = p;
    const bool hasMaterial = primitive.material >= 0 && primitive.material < countOf(scene.materials);
    made.material = hasMaterial ? primitive.material : -1;
    if (!scene.materials.empty()) {
      const LookNeeds needs = hasMaterial ? needsOf(scene.materials[primitive.material]) : LookNeeds();
      reader.readLook(needs, made, statistics, notes);
    }
    scene.meshes.push_back(std::move(made));
  }
  return {};
}

}  // namespace lorica
