#include "skinning/clip_files/gltf_embedding.h"

#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/json.h"
#include "skinning/clip_files/gltf_animation.h"
#include "skinning/import/file_scene.h"
#include "skinning/import/gltf_document.h"
#include "skinning/import/gltf_parts.h"
#include "skinning/import/uri.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

namespace lorica {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMaxFallback = std::uint64_t{1} << 28;  ///< bytes

/// Changes the number of a buffer into bytes of the one buffer.
class BufferMerger {
 public:
  BufferMerger(GltfWriter& writer, const GltfDocument& file) : writer_(writer), file_(file) {}

  [[nodiscard]] Result<void> merge() {
    const Json buffers = writer_.document.value("buffers", Json::array());
    for (std::size_t b = 0; b < buffers.size(); ++b) {  // what the reader has decompressed comes after these
      const std::span<const std::byte> bytes = file_.buffers[b];
      const auto length = buffers[b]["byteLength"].get<std::uint64_t>();
      // For programs without meshopt, whose views must lie in a buffer although it has no content.
      const bool fallback = bytes.empty() && buffers[b].contains("extensions") && length <= kMaxFallback;
      if (bytes.size() < length && !fallback) return unsupported("{}: buffer {} has no content", file_.name, b);
      while (writer_.binary.size() % 4 != 0) writer_.binary.push_back('\0');
      begin_.push_back(writer_.binary.size());
      writer_.binary.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      if (fallback) writer_.binary.append(length, '\0');
    }
    if (begin_.size() <= 1) return {};
    const auto views = writer_.document.find("bufferViews");
    if (views == writer_.document.end()) return {};
    for (Json& view : *views) {
      move(view);
      const auto extensions = view.find("extensions");  // compressed copies of the view
      if (extensions == view.end() || !extensions->is_object()) continue;
      for (Json& extension : *extensions) move(extension);
    }
    return {};
  }

 private:
  void move(Json& reference) {
    const auto buffer = reference.is_object() ? reference.find("buffer") : reference.end();
    if (buffer == reference.end() || !buffer->is_number_unsigned()) return;
    const auto b = buffer->get<std::size_t>();
    if (b >= begin_.size()) return;
    *buffer = 0;
    const auto offset = reference.find("byteOffset");
    const std::size_t within = offset == reference.end() ? 0 : offset->get<std::size_t>();
    reference["byteOffset"] = begin_[b] + within;
  }

  GltfWriter& writer_;
  const GltfDocument& file_;
  std::vector<std::size_t> begin_;
};

/// The kind of a picture by its first bytes; empty if unknown.
[[nodiscard]] std::string mimeTypeOf(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG")) return "image/png";
  if (bytes.starts_with("\xFF\xD8\xFF")) return "image/jpeg";
  if (bytes.starts_with("RIFF") && bytes.substr(0, 12).ends_with("WEBP")) return "image/webp";
  if (bytes.starts_with("\xABKTX 20")) return "image/ktx2";
  return {};
}

/// Takes the pictures of other files into the buffer.
void embedPictures(GltfWriter& writer, const NamedFiles& files, std::vector<std::string>& notes) {
  const auto images = writer.document.find("images");
  if (images == writer.document.end() || !images->is_array()) return;
  for (Json& image : *images) {
    const auto uri = image.is_object() ? image.find("uri") : image.end();
    if (uri == image.end() || !uri->is_string()) continue;
    const std::string text = uri->get<std::string>();
    if (isDataUri(text)) continue;
    const Result<std::filesystem::path> file = files.find(percentDecoded(text));
    const Result<std::string> content = file ? readFile(*file, NamedBy::kFile) : file.error();
    const std::string kind = content ? mimeTypeOf(*content) : std::string();
    if (kind.empty()) {
      notes.push_back(
          fmt::format("the picture '{}' was not found or is of an unknown kind: the output refers to it", text));
      continue;
    }
    image.erase("uri");
    image["mimeType"] = kind;
    image["bufferView"] = writer.addView(*content);
  }
}

/// The same motion of a skeleton that rests as the file's nodes do, which may be in another pose than the character:
/// that has its skin's bind pose. None if all agree.
[[nodiscard]] std::optional<SkeletalMotion> restingAsSaved(const SkeletalMotion& motion, const Json& fileNodes,
                                                           std::span<const int> nodes) {
  bool differs = false;
  std::vector<Joint> joints(motion.skeleton.joints().begin(), motion.skeleton.joints().end());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (nodes[j] == -1) continue;
    const Json& node = fileNodes[nodes[j]];
    FileNode saved;
    const auto read = [&](const char* key, auto& numbers) {
      const auto list = node.find(key);
      if (list == node.end() || std::ssize(*list) != numbers.size()) return false;
      for (Eigen::Index i = 0; i < numbers.size(); ++i) numbers.data()[i] = (*list)[i].template get<double>();
      return true;
    };
    Mat4 matrix;
    if (read("matrix", matrix)) {
      setMatrix(saved, Affine3(Eigen::Matrix<double, 3, 4>(matrix.topRows<3>())));
    } else {
      read("translation", saved.local.translation);
      read("scale", saved.local.scale);
      read("rotation", saved.local.rotation.coeffs());
      const double norm = saved.local.rotation.norm();
      saved.local.rotation = norm > 1e-12 ? saved.local.rotation.normalized() : Quat::Identity();
    }
    JointTransform& rest = joints[j].rest;
    if (saved.inner || saved.local.matrix().isApprox(rest.matrix(), 1e-9)) continue;
    rest = saved.local;
    differs = true;
  }
  if (!differs) return std::nullopt;
  Result<Skeleton> skeleton = Skeleton::create(std::move(joints));
  LORICA_CHECK(skeleton.ok(), "reading the file has checked its nodes");
  return SkeletalMotion{motion.name, std::move(*skeleton), motion.times, motion.poses};
}

}  // namespace

Result<GltfWriter> embedGltf(std::span<const std::byte> bytes, const std::string& name, const NamedFiles& files,
                             std::vector<std::string>& notes) {
  LORICA_TRY(const GltfDocument file, parseGltf(bytes, name, files));
  LORICA_TRY(const GltfParts parts, splitGltf(bytes, name));
  GltfWriter writer;
  LORICA_TRY(writer.document, parseJson<Json>(parts.json, name));
  LORICA_TRY_DO(BufferMerger(writer, file).merge());
  embedPictures(writer, files, notes);
  return writer;
}

Result<void> addAnimationToFile(GltfWriter& writer, const SkeletalMotion& performed, std::span<const int> nodeOfJoint) {
  std::vector<int> nodes(nodeOfJoint.begin(), nodeOfJoint.end());
  for (JointIndex j = 0; j < performed.skeleton.jointCount(); ++j) {
    const JointIndex parent = performed.skeleton.joint(j).parent;
    // The second half of a sheared node, whose matrix is not a transform of this joint alone.
    if (parent != kNoJoint && nodeOfJoint[parent] == -1) nodes[j] = -1;
  }
  const std::optional<SkeletalMotion> saved = restingAsSaved(performed, writer.document["nodes"], nodes);
  const SkeletalMotion& motion = saved ? *saved : performed;
  LORICA_TRY_DO(addAnimation(writer, motion, nodes));
  for (const Json& channel : writer.document["animations"][0]["channels"]) {
    const int index = channel["target"]["node"].get<int>();
    Json& node = writer.document["nodes"][index];
    if (node.erase("matrix") == 0) continue;
    const auto joint = std::find(nodes.begin(), nodes.end(), index) - nodes.begin();
    const JointTransform& rest = motion.skeleton.joint(joint).rest;
    node["translation"] = listOf(rest.translation);
    node["rotation"] = listOf(rest.rotation);
    node["scale"] = listOf(rest.scale);
  }
  return {};
}

}  // namespace lorica
