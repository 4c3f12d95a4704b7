#include "skinning/import/isolated_scene.h"

#include "geometry/byte_reader.h"
#include "geometry/errors.h"
#include "geometry/little_endian.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

namespace lorica {
namespace {

template <typename Index>
[[nodiscard]] bool within(Index index, std::size_t count) {
  return index >= 0 && std::cmp_less(index, count);
}

[[nodiscard]] bool isTurn(const Quat& q) {
  return std::abs(q.norm() - 1.0) < 1e-6;
}

/// Whether no node is its own ancestor.
[[nodiscard]] bool isForest(const FileScene& scene) {
  std::vector<char> reachesRoot(scene.nodes.size(), 0);
  std::vector<int> path;
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    path.clear();
    for (int up = n; up != -1 && reachesRoot[up] == 0; up = scene.nodes[up].parent) {
      path.push_back(up);
      if (path.size() > scene.nodes.size()) return false;
    }
    for (const int node : path) reachesRoot[node] = 1;
  }
  return true;
}

[[nodiscard]] bool areSound(const FileScene& scene, const FileNode& node) {
  return (node.parent == -1 || within(node.parent, scene.nodes.size())) && node.local.translation.allFinite() &&
         node.local.scale.allFinite() && isTurn(node.local.rotation) && (!node.inner || isTurn(*node.inner));
}

[[nodiscard]] bool isSound(const FileScene& scene, const FileSkin& skin) {
  return !skin.nodes.empty() && skin.nodes.size() == skin.jointFromMesh.size() &&
         std::all_of(skin.nodes.begin(), skin.nodes.end(), [&](int n) { return within(n, scene.nodes.size()); }) &&
         std::all_of(skin.jointFromMesh.begin(), skin.jointFromMesh.end(),
                     [](const Affine3& m) { return m.matrix().allFinite(); });
}

[[nodiscard]] bool areSoundWeights(const FileMesh& mesh) {
  if (mesh.skin == -1) return mesh.weightBegin.empty() && mesh.weights.empty();
  return mesh.weightBegin.size() == mesh.positions.size() + 1 && mesh.weightBegin.front() == 0 &&
         mesh.weightBegin.back() == mesh.weights.size() &&
         std::is_sorted(mesh.weightBegin.begin(), mesh.weightBegin.end());
}

[[nodiscard]] bool isSound(const FileScene& scene, const FileMesh& mesh, const FileMorph& morph) {
  const auto unordered = [](const MorphOffset& a, const MorphOffset& b) { return a.vertex >= b.vertex; };
  return within(morph.target, scene.morphTargets.size()) &&
         std::adjacent_find(morph.offsets.begin(), morph.offsets.end(), unordered) == morph.offsets.end() &&
         std::all_of(morph.offsets.begin(), morph.offsets.end(), [&](const MorphOffset& o) {
           return within(o.vertex, mesh.positions.size()) && o.position.allFinite() && o.normal.allFinite();
         });
}

/// One element for each vertex, all finite, or none.
template <typename Element>
[[nodiscard]] bool fits(const std::vector<Element>& list, const FileMesh& mesh) {
  return list.empty() ||
         (list.size() == mesh.positions.size() &&
          std::all_of(list.begin(), list.end(), [](const Element& element) { return element.allFinite(); }));
}

[[nodiscard]] bool isSound(const FileScene& scene, const FileMesh& mesh) {
  const auto inRange = [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](VertexIndex v) { return within(v, mesh.positions.size()); });
  };
  return within(mesh.node, scene.nodes.size()) && (mesh.skin == -1 || within(mesh.skin, scene.skins.size())) &&
         (mesh.material == -1 || within(mesh.material, scene.materials.size())) && !mesh.positions.empty() &&
         fits(mesh.positions, mesh) && std::all_of(mesh.triangles.begin(), mesh.triangles.end(), inRange) &&
         areSoundWeights(mesh) &&
         std::all_of(mesh.morphs.begin(), mesh.morphs.end(),
                     [&](const FileMorph& m) { return isSound(scene, mesh, m); }) &&
         fits(mesh.normals, mesh) && fits(mesh.tangents, mesh) && fits(mesh.uv[0], mesh) && fits(mesh.uv[1], mesh) &&
         fits(mesh.colors, mesh);
}

[[nodiscard]] bool isFinite(const Vec3& v) {
  return v.allFinite();
}
[[nodiscard]] bool isFinite(const Quat& q) {
  return q.coeffs().allFinite();
}

[[nodiscard]] bool areSoundTimes(const std::vector<double>& times) {
  const auto late = [](double a, double b) { return !(a < b); };
  return !times.empty() && std::all_of(times.begin(), times.end(), [](double t) { return std::isfinite(t); }) &&
         std::adjacent_find(times.begin(), times.end(), late) == times.end();
}

template <typename Value>
[[nodiscard]] bool isSound(const std::optional<KeyTrack<Value>>& track) {
  if (!track) return true;
  return track->interpolation == KeyInterpolation::kLinear && areSoundTimes(track->times) &&
         track->values.size() == track->times.size() &&
         std::all_of(track->values.begin(), track->values.end(), [](const Value& value) { return isFinite(value); });
}

/// One target's weights.
[[nodiscard]] bool isSound(const FileScene& scene, const MorphWeightTrack& track) {
  return within(track.firstTarget, scene.morphTargets.size()) && track.targetCount == 1 &&
         track.interpolation == KeyInterpolation::kLinear && areSoundTimes(track.times) &&
         track.values.size() == track.times.size() &&
         std::all_of(track.values.begin(), track.values.end(), [](float value) { return std::isfinite(value); });
}

[[nodiscard]] bool isSound(const FileScene& scene, const FileClip& clip) {
  const auto sound = [&](const FileTrack& track) {
    return within(track.node, scene.nodes.size()) && isSound(track.translation) && isSound(track.rotation) &&
           isSound(track.scale);
  };
  return std::all_of(clip.tracks.begin(), clip.tracks.end(), sound) &&
         std::all_of(clip.weights.begin(), clip.weights.end(),
                     [&](const MorphWeightTrack& track) { return isSound(scene, track); });
}

[[nodiscard]] bool isSound(const FileScene& scene, const Material& material) {
  const auto textures = material.textures();
  const bool used = std::all_of(textures.begin(), textures.end(), [&](const TextureUse* use) {
    return (use->picture == -1 || within(use->picture, scene.pictures.size())) && within(use->uvSet, 2) &&
           use->transform.allFinite() && std::isfinite(use->rotation);
  });
  const auto isShare = [](float number) { return number >= 0.0F && number <= 1.0F; };
  return used && material.baseColor.allFinite() && material.emissive.allFinite() && isShare(material.metallic) &&
         isShare(material.roughness) && std::isfinite(material.normalScale);
}

/// Checks every promise that FileScene makes about nodes, skins, meshes, clips, morph targets and materials.
/// @param name  of the file, for messages
Result<void> checkScene(const FileScene& scene, const std::string& name) {
  const auto unsound = [&](const auto& list, std::string_view what, const auto& check) -> Result<void> {
    const auto found = std::find_if(list.begin(), list.end(), [&](const auto& one) { return !check(one); });
    if (found == list.end()) return {};
    return badFormat("{}: {} {} refers to what is not there, or is not finite", name, what, found - list.begin());
  };
  const auto sound = [&](const auto& one) { return isSound(scene, one); };
  const auto soundTarget = [&](const FileMorphTarget& target) {
    return within(target.node, scene.nodes.size()) && std::isfinite(target.defaultWeight);
  };
  LORICA_TRY_DO(unsound(scene.nodes, "node", [&](const auto& n) { return areSound(scene, n); }));
  if (!isForest(scene)) return badFormat(name + ": a node is its own ancestor");
  LORICA_TRY_DO(unsound(scene.skins, "skin", sound));
  LORICA_TRY_DO(unsound(scene.morphTargets, "morph target", soundTarget));
  LORICA_TRY_DO(unsound(scene.meshes, "mesh", sound));
  LORICA_TRY_DO(unsound(scene.clips, "clip", sound));
  LORICA_TRY_DO(unsound(scene.materials, "material", sound));
  const bool unit = !scene.metresPerUnit || (std::isfinite(*scene.metresPerUnit) && *scene.metresPerUnit > 0.0);
  if (!unit || !isTurn(scene.modelFromFileAxes)) {
    return badFormat(name + ": its unit or axes are not finite");
  }
  return {};
}

/// Appends what it is given.
class Writer {
 public:
  template <typename T>
  void number(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  /// @param end  one past the last value
  template <typename T>
  void choice(const T& value, int /*end*/) {
    number(static_cast<std::uint8_t>(value));
  }
  void text(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes += value;
  }
  template <typename List, typename Each>
  void list(List& values, std::size_t /*bytesEach*/, const Each& each) {
    number(static_cast<std::uint32_t>(values.size()));
    for (auto& value : values) each(value);
  }
  /// Elements that consist of numbers without gaps.
  template <typename T>
  void plain(const std::vector<T>& values) {
    number(static_cast<std::uint32_t>(values.size()));
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
  template <typename T, typename Each>
  void optional(std::optional<T>& value, const Each& each) {
    number(static_cast<std::uint8_t>(value.has_value()));
    if (value) each(*value);
  }

  std::string bytes;
};

/// Reads the same in the same order. After the first failure everything is empty or 0.
class Reader {
 public:
  Reader(std::string_view bytes, const std::string& name) : in(bytes, 0, name) {}

  template <typename T>
  void number(T& value) {
    value = in.take<T>();
  }
  template <typename T>
  void choice(T& value, int end) {
    const auto found = in.take<std::uint8_t>();
    if (found >= end) in.fail(in.offset(), fmt::format("found choice {}, expected 0 to {}", found, end - 1));
    value = static_cast<T>(in.ok() ? found : 0);
  }
  void text(std::string& value) { value = in.takeText(in.takeCount("a length", 1)); }
  template <typename List, typename Each>
  void list(List& values, std::size_t bytesEach, const Each& each) {
    const std::size_t count = in.takeCount("a count", bytesEach);
    for (std::size_t i = 0; i < count && in.ok(); ++i) each(values.emplace_back());
  }
  template <typename T>
  void plain(std::vector<T>& values) {
    values.resize(in.takeCount("a count", sizeof(T)));
    const std::size_t bytes = values.size() * sizeof(T);
    if (bytes == 0) return;
    std::memcpy(static_cast<void*>(values.data()), in.rest().data(), bytes);
    in.skip(bytes);
  }
  template <typename T, typename Each>
  void optional(std::optional<T>& value, const Each& each) {
    int given = 0;
    choice(given, 2);
    if (given == 0) return;
    value.emplace();
    each(*value);
  }

  ByteReader in;
};

/// Lists the members of a scene once, for writing and for reading.
template <typename Archive>
class Members {
 public:
  explicit Members(Archive& archive) : a_(archive) {}

  template <typename Scene>
  void scene(Scene& s) {
    all(s.format);
    a_.list(s.nodes, 80, [&](auto& node) { this->node(node); });
    a_.list(s.skins, 12, [&](auto& skin) { all(skin.name, skin.nodes, skin.jointFromMesh); });
    a_.list(s.meshes, 60, [&](auto& mesh) { this->mesh(mesh); });
    a_.list(s.clips, 12, [&](auto& clip) { this->clip(clip); });
    a_.list(s.morphTargets, 20, [&](auto& t) { all(t.name, t.node, t.mesh, t.index, t.defaultWeight); });
    a_.list(s.materials, 190, [&](auto& one) { material(one); });
    a_.list(s.pictures, 8, [&](auto& picture) { all(picture.name, picture.bytes); });
    a_.optional(s.metresPerUnit, [&](auto& metres) { all(metres); });
    all(s.modelFromFileAxes.coeffs(), s.meshCount, s.primitiveCount, s.morphTargetCount);
    a_.list(s.notes, 4, [&](auto& note) { all(note); });
  }

 private:
  template <typename... Values>
  void all(Values&... values) {
    (one(values), ...);
  }
  void one(std::string& text) { a_.text(text); }
  template <typename Element>
  void one(std::vector<Element>& values) {
    a_.plain(values);
  }
  template <typename Value>
  void one(Value& value) {
    if constexpr (std::is_arithmetic_v<Value>) {
      a_.number(value);
    } else {
      for (auto& x : value.reshaped()) a_.number(x);  // a vector or matrix of fixed size
    }
  }

  template <typename Node>
  void node(Node& n) {
    all(n.name, n.parent, n.local.translation, n.local.rotation.coeffs(), n.local.scale);
    a_.optional(n.inner, [&](auto& turn) { all(turn.coeffs()); });
  }

  template <typename Mesh>
  void mesh(Mesh& m) {
    all(m.name, m.node, m.skin, m.positions, m.triangles, m.weights, m.weightBegin);
    a_.list(m.morphs, 8, [&](auto& morph) { all(morph.target, morph.offsets); });
    all(m.normals, m.tangents);
    for (auto& set : m.uv) all(set);
    all(m.colors, m.material);
  }

  template <typename Clip>
  void clip(Clip& c) {
    all(c.name);
    a_.list(c.tracks, 7, [&](auto& track) {
      all(track.node);
      a_.optional(track.translation, [&](auto& keys) { this->keys(keys); });
      a_.optional(track.rotation, [&](auto& keys) { this->keys(keys); });
      a_.optional(track.scale, [&](auto& keys) { this->keys(keys); });
    });
    a_.list(c.weights, 17, [&](auto& track) {
      all(track.firstTarget, track.targetCount);
      keys(track);
    });
  }

  template <typename Keys>
  void keys(Keys& k) {
    a_.choice(k.interpolation, 3);
    all(k.times, k.values);
  }

  template <typename Use>
  void texture(Use& t) {
    all(t.picture, t.uvSet);
    a_.choice(t.wrapU, 3);
    a_.choice(t.wrapV, 3);
    all(t.transform, t.rotation);
  }

  template <typename Material>
  void material(Material& m) {
    all(m.name);
    a_.choice(m.shading, 3);
    all(m.baseColor);
    texture(m.base);
    all(m.metallic, m.roughness);
    texture(m.normal);
    all(m.normalScale);
    texture(m.occlusion);
    all(m.emissive);
    texture(m.emissiveTexture);
    a_.choice(m.alpha, 3);
    a_.choice(m.doubleSided, 2);
  }

  Archive& a_;
};

}  // namespace

std::string encodeScene(const FileScene& scene) {
  Writer writer;
  // The writer reads only; Members needs one list of members for both directions.
  Members(writer).scene(const_cast<FileScene&>(scene));
  return std::move(writer.bytes);
}

Result<FileScene> decodeScene(std::string_view bytes, const std::string& name) {
  Reader reader(bytes, name);
  FileScene scene;
  Members(reader).scene(scene);
  if (reader.in.ok() && reader.in.left() > 0) reader.in.fail(reader.in.offset(), "found more, expected the end");
  if (!reader.in.ok()) return reader.in.error();
  LORICA_TRY_DO(checkScene(scene, name));
  return scene;
}

}  // namespace lorica

namespace lorica::isolated {

namespace {

constexpr std::size_t kLongestMessage = 10'000;  // [bytes]

enum class AnswerKind : std::uint8_t { kScene, kError };

void appendText(std::string_view text, std::string& bytes) {
  appendLittleEndian(static_cast<std::uint32_t>(text.size()), bytes);
  bytes += text;
}

}  // namespace

std::string encodeHead(AssimpFormat format, const std::string& name, const NamedFiles& files) {
  std::string bytes;
  appendLittleEndian(static_cast<std::uint8_t>(format), bytes);
  appendLittleEndian(static_cast<std::uint8_t>(files.trust), bytes);
  appendText(name, bytes);
  appendText(files.folder.string(), bytes);
  return bytes;
}

Result<Head> decodeHead(std::string_view& question) {
  ByteReader in(question, 0, "question");
  Head head;
  head.format = static_cast<AssimpFormat>(in.take<std::uint8_t>() == 1);
  head.files.trust = static_cast<PathTrust>(in.take<std::uint8_t>() == 1);
  head.name = in.takeText(in.takeCount("a length", 1));
  head.files.folder = in.takeText(in.takeCount("a length", 1));
  if (!in.ok()) return in.error();
  question = in.rest();
  return head;
}

std::string encodeAnswer(const Result<FileScene>& answer) {
  std::string bytes;
  if (answer) {
    appendLittleEndian(static_cast<std::uint8_t>(AnswerKind::kScene), bytes);
    bytes += encodeScene(*answer);
  } else {
    appendLittleEndian(static_cast<std::uint8_t>(AnswerKind::kError), bytes);
    appendLittleEndian(static_cast<std::uint8_t>(answer.error().code), bytes);
    appendText(firstBytes(answer.error().message, kLongestMessage), bytes);
  }
  return bytes;
}

Result<FileScene> decodeAnswer(std::string_view answer, const std::string& name) {
  ByteReader in(answer, 0, name + ": the answer of its reader");
  const auto kind = in.take<std::uint8_t>();
  if (in.ok() && kind == static_cast<std::uint8_t>(AnswerKind::kScene)) return decodeScene(in.rest(), name);
  const auto code = in.take<std::uint8_t>();
  std::string message = in.takeText(std::min(in.takeCount("a length", 1), kLongestMessage));
  if (in.ok() && kind != static_cast<std::uint8_t>(AnswerKind::kError))
    in.fail(0, "found neither a scene nor an error");
  if (!in.ok()) return in.error();
  const bool missing = code == static_cast<std::uint8_t>(ErrorCode::kUnsupported);
  return Error{missing ? ErrorCode::kUnsupported : ErrorCode::kBadFormat, std::move(message)};
}

}  // namespace lorica::isolated
