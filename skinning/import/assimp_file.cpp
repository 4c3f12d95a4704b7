#include "skinning/import/scene_readers.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/little_endian.h"
#include "geometry/result.h"
#include "skinning/import/assimp_parts.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace lorica {

namespace {

constexpr std::string_view kBlanks = " \t\r\n";

/// A start tag: "accessor" and "source="#a" count="4"".
struct Tag {
  std::string_view name;
  std::string_view attributes;
};

[[nodiscard]] Tag tagOf(std::string_view inside) {
  const std::size_t end = std::min(inside.find_first_of(" \t\r\n/"), inside.size());
  std::string_view name = inside.substr(0, end);
  if (const std::size_t colon = name.find(':'); colon != std::string_view::npos) name.remove_prefix(colon + 1);
  return {name, inside.substr(end)};
}

/// An attribute's text; none if the tag lacks it.
[[nodiscard]] std::optional<std::string_view> attribute(const Tag& tag, std::string_view name) {
  for (std::size_t at = tag.attributes.find(name); at != std::string_view::npos;
       at = tag.attributes.find(name, at + 1)) {
    if (at == 0 || kBlanks.find(tag.attributes[at - 1]) == std::string_view::npos) continue;
    std::string_view rest = tag.attributes.substr(at + name.size());
    rest.remove_prefix(std::min(rest.find_first_not_of(kBlanks), rest.size()));
    if (!rest.starts_with('=')) continue;
    rest.remove_prefix(1);
    rest.remove_prefix(std::min(rest.find_first_not_of(kBlanks), rest.size()));
    if (rest.empty() || (rest.front() != '"' && rest.front() != '\'')) continue;
    const std::size_t end = rest.find(rest.front(), 1);
    if (end == std::string_view::npos) return std::nullopt;
    return rest.substr(1, end - 1);
  }
  return std::nullopt;
}

[[nodiscard]] std::optional<std::uint64_t> wholeNumber(std::optional<std::string_view> text) {
  if (!text) return std::nullopt;
  std::uint32_t value = 0;  // so that the products below fit into 64 bits
  const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), value);
  if (error != std::errc{} || end != text->data() + text->size()) return std::nullopt;
  return value;
}

class ColladaCheck {
 public:
  ColladaCheck(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  [[nodiscard]] Result<void> run() {
    for (std::size_t open = text_.find('<'); open != std::string_view::npos; open = text_.find('<', open + 1)) {
      if (text_.substr(open).starts_with("<!--")) {
        const std::size_t end = text_.find("-->", open);
        if (end == std::string_view::npos) return {};  // left to assimp to reject
        open = end;
        continue;
      }
      const std::size_t close = text_.find('>', open);
      if (close == std::string_view::npos) return {};
      const Tag tag = tagOf(text_.substr(open + 1, close - open - 1));
      const std::size_t end = std::min(text_.find('<', close), text_.size());
      LORICA_TRY_DO(checkTag(tag, close + 1, end, open));
    }
    return checkAccessors();
  }

  /// The text if it must be another one: <up_axis> without blanks around its value, which assimp 5.2 would not know.
  [[nodiscard]] std::optional<std::string> changed() const {
    if (upAxis_.empty()) return std::nullopt;
    std::string text;
    const char* copied = text_.data();
    for (const std::string_view content : upAxis_) {
      if (content.data() < copied) continue;  // of two tags that are one in the other
      const std::size_t first = std::min(content.find_first_not_of(kBlanks), content.size());
      text.append(copied, content.data());
      text += content.substr(first, content.find_last_not_of(kBlanks) + 1 - first);
      copied = content.data() + content.size();
    }
    return text.append(copied, text_.data() + text_.size());
  }

 private:
  struct Accessor {
    std::string_view source;
    std::uint64_t end = 0;  ///< one past the last number that it reads
    std::size_t at = 0;
  };

  [[nodiscard]] Error bad(std::size_t at, const std::string& what) const {
    const auto line = 1 + std::count(text_.begin(), text_.begin() + at, '\n');
    return badFormat("{}: line {}: {}", name_, line, what);
  }

  [[nodiscard]] Result<void> checkTag(const Tag& tag, std::size_t begin, std::size_t end, std::size_t at) {
    const std::string_view content = text_.substr(begin, end - begin);
    const auto isBlank = [](char c) { return kBlanks.find(c) != std::string_view::npos; };
    if (tag.name == "up_axis" && !content.empty() && (isBlank(content.front()) || isBlank(content.back()))) {
      upAxis_.push_back(content);
    }
    constexpr std::array<std::string_view, 5> kWholeNumbers = {"p", "h", "v", "vcount", "int_array"};
    if (std::find(kWholeNumbers.begin(), kWholeNumbers.end(), tag.name) != kWholeNumbers.end()) {
      const std::size_t odd = text_.substr(0, end).find_first_not_of("0123456789+- \t\r\n", begin);
      if (odd != std::string_view::npos) {
        return bad(odd, fmt::format("<{}> contains byte {}, expected whole numbers", tag.name,
                                    static_cast<int>(static_cast<unsigned char>(text_[odd]))));
      }
    }
    if (tag.name == "float_array" || tag.name == "Name_array" || tag.name == "IDREF_array") {
      const std::optional<std::uint64_t> count = wholeNumber(attribute(tag, "count"));
      if (!count) return bad(at, fmt::format("<{}> has no count, expected a whole number", tag.name));
      // Each needs at least one character, with a blank between.
      if (*count > (end - begin + 1) / 2) {
        return bad(at,
                   fmt::format("<{}> declares {} values in {} bytes", tag.name, grouped(*count), grouped(end - begin)));
      }
      if (const auto id = attribute(tag, "id")) counts_[*id] = *count;
    }
    if (tag.name == "accessor") {
      const std::optional<std::string_view> source = attribute(tag, "source");
      const std::optional<std::uint64_t> count = wholeNumber(attribute(tag, "count"));
      const std::optional<std::uint64_t> stride = wholeNumber(attribute(tag, "stride").value_or("1"));
      const std::optional<std::uint64_t> offset = wholeNumber(attribute(tag, "offset").value_or("0"));
      if (!source || !source->starts_with('#') || !count || !stride || !offset) {
        return bad(at, "<accessor> needs a source in this file and whole numbers for count, stride and offset");
      }
      accessors_.push_back({source->substr(1), *offset + *count * *stride, at});
    }
    return {};
  }

  [[nodiscard]] Result<void> checkAccessors() const {
    for (const Accessor& accessor : accessors_) {
      const auto array = counts_.find(accessor.source);
      if (array == counts_.end()) {
        return bad(accessor.at, fmt::format("<accessor> reads from '{}', which does not exist", accessor.source));
      }
      if (accessor.end > array->second) {
        return bad(accessor.at, fmt::format("<accessor> reads {} values of '{}', which has {}", grouped(accessor.end),
                                            accessor.source, grouped(array->second)));
      }
    }
    return {};
  }

  std::string_view text_;
  const std::string& name_;
  std::map<std::string_view, std::uint64_t> counts_;  // number of values of each array, by its id
  std::vector<Accessor> accessors_;
  std::vector<std::string_view> upAxis_;  ///< contents with blanks at an end, in the order of the text
};

/// Rejects COLLADA files that assimp 5.2 cannot handle: lists of whole numbers with other content cause an endless
/// loop, and accessors that reach beyond their array terminate the program.
/// @param text  of the file in UTF-8
/// @return the text that assimp is to read instead, if there is one
[[nodiscard]] Result<std::optional<std::string>> checkCollada(std::string_view text, const std::string& name) {
  ColladaCheck check(text, name);
  LORICA_TRY_DO(check.run());
  return check.changed();
}

/// Prevents assimp from reading any other file.
class NoOtherFiles : public Assimp::IOSystem {
 public:
  bool Exists(const char* /*file*/) const override { return false; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* /*file*/, const char* /*mode*/) override { return nullptr; }
  void Close(Assimp::IOStream* /*file*/) override {}
};

[[nodiscard]] Vec3 asVec3(const aiVector3D& v) {
  return {v.x, v.y, v.z};
}

[[nodiscard]] Quat asQuat(const aiQuaternion& q) {
  return Quat(q.w, q.x, q.y, q.z);
}

[[nodiscard]] const Vec3& coefficients(const Vec3& v) {
  return v;
}

[[nodiscard]] const Eigen::Vector4d& coefficients(const Quat& q) {
  return q.coeffs();
}

[[nodiscard]] Affine3 asAffine(const aiMatrix4x4& m) {
  Eigen::Matrix<double, 3, 4> rows;
  rows << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4;
  return Affine3(rows);
}

/// A number from the scene's metadata, whatever its stored type.
[[nodiscard]] std::optional<double> metadata(const aiScene& scene, const char* key) {
  if (scene.mMetaData == nullptr) return std::nullopt;
  if (double number = 0.0; scene.mMetaData->Get(key, number)) return number;
  if (float number = 0.0F; scene.mMetaData->Get(key, number)) return number;
  if (int number = 0; scene.mMetaData->Get(key, number)) return number;
  return std::nullopt;
}

/// The rotation that maps an FBX file's right, up and front to X, Y and Z.
[[nodiscard]] Quat fbxAxes(const aiScene& scene) {
  Mat3 modelFromFile = Mat3::Zero();
  const std::array<std::pair<const char*, const char*>, 3> rows = {
      {{"CoordAxis", "CoordAxisSign"}, {"UpAxis", "UpAxisSign"}, {"FrontAxis", "FrontAxisSign"}}};
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const double axis = metadata(scene, rows[row].first).value_or(row == 0 ? 0.0 : row == 1 ? 1.0 : 2.0);
    const double sign = metadata(scene, rows[row].second).value_or(1.0);
    if (axis != 0.0 && axis != 1.0 && axis != 2.0) return Quat::Identity();
    modelFromFile(row, static_cast<Eigen::Index>(axis)) = sign < 0.0 ? -1.0 : 1.0;
  }
  // Mirrored or repeated axes are not a rotation; then only the up axis is used.
  if (modelFromFile.determinant() > 0.5) return Quat(modelFromFile).normalized();
  const Vec3 up = modelFromFile.row(1);
  return rotationBetween(up, Vec3::UnitY());
}

class AssimpSceneReader {
 public:
  AssimpSceneReader(const aiScene& scene, const std::string& name, const NamedFiles& files)
      : from_(scene), name_(name), files_(files) {}

  [[nodiscard]] Result<FileScene> read(AssimpFormat format) {
    scene_.format = format == AssimpFormat::kFbx ? "FBX" : "COLLADA";
    scene_.metresPerUnit = 1.0;  // assimp puts COLLADA's unit and axes into the root node
    if (format == AssimpFormat::kFbx) {
      const double centimetres = metadata(from_, "UnitScaleFactor").value_or(1.0);
      const bool usable = centimetres > 1e-6 && centimetres < 1e6;
      if (!usable) scene_.notes.push_back(fmt::format("its unit of {} cm is invalid: assuming 1 cm", centimetres));
      scene_.metresPerUnit = 0.01 * (usable ? centimetres : 1.0);
      scene_.modelFromFileAxes = fbxAxes(from_);
    }
    if (from_.mRootNode == nullptr) return badFormat("{}: has no nodes", name_);
    LORICA_TRY_DO(readNodes());
    addAssimpMaterials(from_, files_, scene_);
    LORICA_TRY_DO(readMeshes());
    LORICA_TRY_DO(readClips());
    return std::move(scene_);
  }

 private:
  [[nodiscard]] Result<void> readNodes() {
    std::vector<std::pair<const aiNode*, int>> stack = {{from_.mRootNode, -1}};
    while (!stack.empty()) {
      const auto [node, parent] = stack.back();
      stack.pop_back();
      const int index = countOf(scene_.nodes);
      FileNode made;
      made.name = textOf(node->mName);
      if (made.name.empty()) made.name = fmt::format("node {}", index);
      made.parent = parent;
      // FBX has no root node. assimp makes one, and from 5.4 on it holds the file's axes, for which we have fbxAxes().
      const bool madeUp = parent < 0 && scene_.format == "FBX";
      const Affine3 parentFromNode = madeUp ? Affine3::Identity() : asAffine(node->mTransformation);
      if (!parentFromNode.matrix().allFinite()) {
        return badFormat("{}: node '{}': contains a non-finite number", name_, made.name);
      }
      setMatrix(made, parentFromNode);
      nodeOfName_.emplace(made.name, index);
      nodes_.push_back(node);
      scene_.nodes.push_back(std::move(made));
      for (unsigned c = node->mNumChildren; c-- > 0;) {
        if (node->mChildren[c] != nullptr) stack.emplace_back(node->mChildren[c], index);
      }
    }
    return {};
  }

  [[nodiscard]] Result<void> readMeshes() {
    scene_.meshCount = from_.mNumMeshes;
    scene_.primitiveCount = scene_.meshCount;
    std::vector<int> skinOfMesh(from_.mNumMeshes, -1);
    for (unsigned m = 0; m < from_.mNumMeshes; ++m) {
      const aiMesh& mesh = *from_.mMeshes[m];
      scene_.morphTargetCount += mesh.mNumAnimMeshes;
      LORICA_TRY(const bool skinned, addSkin(mesh));
      if (skinned) skinOfMesh[m] = countOf(scene_.skins) - 1;
    }
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      for (unsigned i = 0; i < nodes_[n]->mNumMeshes; ++i) {
        const unsigned m = nodes_[n]->mMeshes[i];
        if (m >= from_.mNumMeshes) {
          return badFormat("{}: node '{}': refers to mesh {}, expected 0 to {}", name_, scene_.nodes[n].name, m,
                           static_cast<int>(from_.mNumMeshes) - 1);
        }
        LORICA_TRY_DO(addMesh(*from_.mMeshes[m], n, skinOfMesh[m]));
      }
    }
    scene_.note(otherFaces_, "face is a point, a line or uses a vertex twice: skipped",
                "faces are points, lines or use a vertex twice: skipped");
    scene_.note(notFinite_, "number of normals, tangents or texture coordinates is not finite: replaced by 0",
                "numbers of normals, tangents or texture coordinates are not finite: replaced by 0");
    scene_.note(lostBones_, "bone refers to no node: its vertices follow the other bones of the mesh",
                "bones refer to no node: their vertices follow the other bones of the mesh");
    return {};
  }

  /// Adds the bones of a mesh as a skin. @return whether the mesh has bones
  [[nodiscard]] Result<bool> addSkin(const aiMesh& mesh) {
    FileSkin skin;
    skin.name = textOf(mesh.mName);
    skin.nodes.reserve(mesh.mNumBones);
    skin.jointFromMesh.reserve(mesh.mNumBones);
    std::vector<std::int64_t> positions(mesh.mNumBones, -1);
    for (unsigned b = 0; b < mesh.mNumBones; ++b) {
      const aiBone& bone = *mesh.mBones[b];
      const auto node = nodeOfName_.find(textOf(bone.mName));
      if (node == nodeOfName_.end()) {
        ++lostBones_;
        continue;
      }
      const Affine3 offset = asAffine(bone.mOffsetMatrix);
      if (!offset.matrix().allFinite()) {
        return badFormat("{}: mesh '{}', bone '{}': contains a non-finite number", name_, skin.name,
                         textOf(bone.mName));
      }
      positions[b] = skin.nodes.size();
      skin.nodes.push_back(node->second);
      skin.jointFromMesh.push_back(offset);
    }
    if (skin.nodes.empty()) return false;
    scene_.skins.push_back(std::move(skin));
    positionOfBone_.push_back(std::move(positions));
    return true;
  }

  [[nodiscard]] Result<void> addMesh(const aiMesh& from, int node, int skin) {
    FileMesh mesh;
    mesh.name = textOf(from.mName);
    mesh.node = node;
    mesh.skin = skin;
    mesh.positions.reserve(from.mNumVertices);
    for (unsigned v = 0; v < from.mNumVertices; ++v) {
      mesh.positions.push_back(asVec3(from.mVertices[v]));
      if (!mesh.positions.back().allFinite()) {
        return badFormat("{}: mesh '{}': position {} is not finite", name_, mesh.name, v);
      }
    }
    mesh.triangles.reserve(from.mNumFaces);
    for (unsigned f = 0; f < from.mNumFaces; ++f) {
      const aiFace& face = from.mFaces[f];
      const std::span<const unsigned> corners(face.mIndices, face.mNumIndices);
      if (std::any_of(corners.begin(), corners.end(), [&](unsigned v) { return v >= from.mNumVertices; })) {
        return badFormat("{}: mesh '{}': face {} refers to a vertex out of range, the mesh has {}", name_, mesh.name, f,
                         from.mNumVertices);
      }
      if (corners.size() != 3 || corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) {
        ++otherFaces_;
        continue;
      }
      mesh.triangles.push_back({static_cast<VertexIndex>(corners[0]), static_cast<VertexIndex>(corners[1]),
                                static_cast<VertexIndex>(corners[2])});
    }
    if (mesh.triangles.empty()) return {};
    if (skin != -1) addWeights(from, mesh);
    addAssimpLook(from, scene_, mesh, notFinite_);
    morphs_.add(from, mesh);
    scene_.meshes.push_back(std::move(mesh));
    return {};
  }

  /// Converts a list of vertices for each bone to a list of bones for each vertex.
  void addWeights(const aiMesh& from, FileMesh& mesh) const {
    const std::vector<std::int64_t>& positions = positionOfBone_[mesh.skin];
    const auto forEach = [&](const auto& use) {
      for (unsigned b = 0; b < from.mNumBones; ++b) {
        if (positions[b] == -1) continue;
        for (unsigned w = 0; w < from.mBones[b]->mNumWeights; ++w) {
          const aiVertexWeight& weight = from.mBones[b]->mWeights[w];
          if (weight.mVertexId < from.mNumVertices) use(b, weight);
        }
      }
    };
    std::vector<std::size_t> next(mesh.positions.size() + 1, 0);
    forEach([&](unsigned, const aiVertexWeight& w) { ++next[w.mVertexId + 1]; });
    for (std::size_t v = 1; v < next.size(); ++v) next[v] += next[v - 1];
    mesh.weightBegin = next;
    mesh.weights.resize(next.back());
    forEach([&](unsigned b, const aiVertexWeight& w) {
      mesh.weights[next[w.mVertexId]++] = {positions[b], w.mWeight};
    });
  }

  template <typename Value, typename Key, typename Convert>
  void addTrack(const Key* keys, unsigned count, double secondsPerTick, const Convert& convert,
                std::optional<KeyTrack<Value>>& out) {
    KeyTrack<Value> track;
    track.times.reserve(count);
    track.values.reserve(count);
    for (unsigned k = 0; k < count; ++k) {
      const double time = keys[k].mTime * secondsPerTick;
      const Value value = convert(keys[k].mValue);
      const bool finite = std::isfinite(time) && coefficients(value).allFinite();
      if (!finite || (!track.times.empty() && time <= track.times.back())) {
        ++lateKeys_;
        continue;
      }
      track.times.push_back(time);
      track.values.push_back(value);
    }
    if (!track.times.empty()) out = std::move(track);
  }

  [[nodiscard]] Result<void> readClips() {
    std::uint64_t lostChannels = 0;
    for (unsigned a = 0; a < from_.mNumAnimations; ++a) {
      const aiAnimation& from = *from_.mAnimations[a];
      FileClip clip;
      clip.name = textOf(from.mName);
      if (clip.name.empty()) clip.name = fmt::format("clip {}", a);
      const double secondsPerTick = 1.0 / (from.mTicksPerSecond > 0.0 ? from.mTicksPerSecond : 25.0);
      for (unsigned c = 0; c < from.mNumChannels; ++c) {
        const aiNodeAnim& channel = *from.mChannels[c];
        const auto node = nodeOfName_.find(textOf(channel.mNodeName));
        if (node == nodeOfName_.end()) {
          ++lostChannels;
          continue;
        }
        FileTrack track;
        track.node = node->second;
        addTrack(channel.mPositionKeys, channel.mNumPositionKeys, secondsPerTick, asVec3, track.translation);
        addTrack(channel.mRotationKeys, channel.mNumRotationKeys, secondsPerTick, asQuat, track.rotation);
        addTrack(channel.mScalingKeys, channel.mNumScalingKeys, secondsPerTick, asVec3, track.scale);
        clip.tracks.push_back(std::move(track));
      }
      morphs_.addWeights(from, secondsPerTick, nodeOfName_, clip);
      scene_.clips.push_back(std::move(clip));
    }
    scene_.note(lostChannels, "animation channel refers to no node: skipped",
                "animation channels refer to no node: skipped");
    scene_.note(lateKeys_, "animation key is not finite or not later than the previous key: skipped",
                "animation keys are not finite or not later than the previous key: skipped");
    morphs_.finish();
    return {};
  }

  const aiScene& from_;
  const std::string& name_;
  const NamedFiles& files_;
  FileScene scene_;
  AssimpMorphs morphs_{scene_};
  std::vector<const aiNode*> nodes_;
  std::map<std::string, int> nodeOfName_;                  // the first of that name, as in assimp's own lookup
  std::vector<std::vector<std::int64_t>> positionOfBone_;  // per skin: indices of assimp's bones in its nodes, or -1
  std::uint64_t otherFaces_ = 0;
  std::uint64_t notFinite_ = 0;
  std::uint64_t lostBones_ = 0;
  std::uint64_t lateKeys_ = 0;
};

/// The version that an FBX file states, such as 7400 for 7.4; 0 if it states none.
[[nodiscard]] int fbxVersionOf(std::string_view text) {
  if (text.starts_with("Kaydara FBX Binary")) {
    constexpr std::size_t kAt = 23;
    const auto version = kAt + 4 <= text.size() ? loadLittleEndian<std::uint32_t>(text.data() + kAt) : 0;
    return version < 100'000 ? static_cast<int>(version) : 0;
  }
  constexpr std::string_view kKey = "FBXVersion:";
  const std::string_view start = text.substr(0, 4096);
  std::size_t at = start.find(kKey);
  if (at == std::string_view::npos) return 0;
  at = std::min(start.find_first_not_of(" \t", at + kKey.size()), start.size());
  int version = 0;
  std::from_chars(start.data() + at, start.data() + start.size(), version);
  return version;
}

}  // namespace

Result<FileScene> readAssimpScene(std::span<const std::byte> bytes, const std::string& name, AssimpFormat format,
                                  const NamedFiles& files) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::optional<std::string> changed;
  if (format == AssimpFormat::kCollada) {
    LORICA_TRY(changed, checkCollada(text, name));
    if (changed) text = *changed;
  }
  constexpr int kOldestFbx = 7100;
  const int version = format == AssimpFormat::kFbx ? fbxVersionOf(text) : 0;
  if (version > 0 && version < kOldestFbx) {
    return unsupported("{}: FBX {}.{} is too old: export it as FBX 7.x (2011 or later)", name, version / 1000,
                       version / 100 % 10);
  }
  const char* formatName = format == AssimpFormat::kFbx ? "FBX" : "COLLADA";
  try {
    Assimp::Importer importer;
    importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);  // otherwise motion files get generated meshes
    importer.SetIOHandler(new NoOtherFiles);                              // owned by the importer
    const aiScene* scene = importer.ReadFileFromMemory(text.data(), text.size(), aiProcess_Triangulate,
                                                       format == AssimpFormat::kFbx ? "fbx" : "dae");
    if (scene == nullptr) {
      return badFormat("{}: broken {}: {}", name, formatName, importer.GetErrorString());
    }
    return AssimpSceneReader(*scene, name, files).read(format);
  } catch (const std::exception& problem) {
    return badFormat("{}: broken {}: {}", name, formatName, problem.what());
  }
}

}  // namespace lorica
