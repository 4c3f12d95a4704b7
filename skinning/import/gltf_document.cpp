#include "skinning/import/gltf_document.h"

#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/json.h"
#include "geometry/little_endian.h"
#include "geometry/work_budgets.h"
#include "skinning/import/file_scene.h"
#include "skinning/import/json_values.h"
#include "skinning/import/uri.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string_view>

namespace lorica {
namespace {

using Json = nlohmann::json;
using Bytes = std::span<const std::byte>;

[[nodiscard]] std::string_view textIn(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

[[nodiscard]] Result<GltfParts> splitGlb(Bytes bytes, const std::string& name) {
  constexpr std::size_t kHeaderBytes = 12;
  constexpr std::size_t kChunkHeaderBytes = 8;
  constexpr std::uint32_t kJson = 0x4E4F534A;
  constexpr std::uint32_t kBinary = 0x004E4942;
  const auto numberAt = [&](std::size_t at) { return loadLittleEndian<std::uint32_t>(textIn(bytes).data() + at); };

  if (bytes.size() < kHeaderBytes) {
    return badFormat("{}: {} bytes, expected at least {} for a GLB header: the file is truncated", name, bytes.size(),
                     kHeaderBytes);
  }
  const std::uint32_t version = numberAt(4);
  if (version != 2) {
    return unsupported("{}: GLB version {}, expected 2", name, version);
  }
  const std::uint32_t length = numberAt(8);
  if (length > bytes.size()) {
    return badFormat("{}: its header declares {} bytes, the file has {}: it is truncated", name, grouped(length),
                     grouped(bytes.size()));
  }
  bytes = bytes.first(length);

  GltfParts parts;
  std::size_t at = kHeaderBytes;
  for (int chunk = 0; at < bytes.size(); ++chunk) {
    if (bytes.size() - at < kChunkHeaderBytes) {
      if (chunk >= 1) break;  // padding that some writers leave behind
      return badFormat("{}: chunk {} starts at byte {} of {}, which leaves no room for its header", name, chunk,
                       grouped(at), grouped(bytes.size()));
    }
    const std::uint32_t chunkBytes = numberAt(at);
    const std::uint32_t kind = numberAt(at + 4);
    at += kChunkHeaderBytes;
    if (chunkBytes > bytes.size() - at) {
      return badFormat("{}: chunk {} of {} bytes starts at byte {} and ends past the file's {}", name, chunk,
                       grouped(chunkBytes), grouped(at), grouped(bytes.size()));
    }
    const Bytes content = bytes.subspan(at, chunkBytes);
    if (chunk == 0 && kind != kJson) return badFormat("{}: chunk 0 has type {:#x}, expected JSON", name, kind);
    if (chunk == 0) parts.json = textIn(content);
    if (chunk > 0 && kind == kBinary && !parts.binary) parts.binary = content;
    at += chunkBytes;
  }
  if (parts.json.empty()) return badFormat("{}: the GLB has no JSON chunk", name);
  return parts;
}

enum class FieldKind {
  kSize,       ///< a whole number from 0 on
  kReference,  ///< a whole number; whether that element exists is checked where it is used, but -1 means none in
               ///< tinygltf
  kNumber,
  kText,
  kBool,
};

struct Rule {
  std::string_view path;  ///< keys; * stands for each element or member
  FieldKind kind;
  bool required = false;  ///< in each object that the path leads to
};

// Properties that are not listed are of no use here or are checked elsewhere. Each list comes with the path of its
// elements, which makes it a list.
constexpr Rule kRules[] = {
    {"scene", FieldKind::kReference},
    {"bufferViews/*/buffer", FieldKind::kReference},
    {"bufferViews/*/byteOffset", FieldKind::kSize},
    {"bufferViews/*/byteLength", FieldKind::kSize},
    {"bufferViews/*/byteStride", FieldKind::kSize},
    {"accessors/*/bufferView", FieldKind::kReference},
    {"accessors/*/byteOffset", FieldKind::kSize},
    {"accessors/*/componentType", FieldKind::kReference},
    {"accessors/*/count", FieldKind::kSize},
    {"accessors/*/type", FieldKind::kText},
    {"accessors/*/normalized", FieldKind::kBool},
    {"accessors/*/sparse/count", FieldKind::kSize},
    {"accessors/*/sparse/indices/bufferView", FieldKind::kReference},
    {"accessors/*/sparse/indices/byteOffset", FieldKind::kSize},
    {"accessors/*/sparse/indices/componentType", FieldKind::kReference},
    {"accessors/*/sparse/values/bufferView", FieldKind::kReference},
    {"accessors/*/sparse/values/byteOffset", FieldKind::kSize},
    {"meshes/*/primitives/*/attributes/*", FieldKind::kReference},
    {"meshes/*/primitives/*/targets/*/*", FieldKind::kReference},
    {"meshes/*/primitives/*/indices", FieldKind::kReference},
    {"meshes/*/primitives/*/material", FieldKind::kReference},
    {"meshes/*/primitives/*/mode", FieldKind::kReference},
    {"meshes/*/weights/*", FieldKind::kNumber},
    {"nodes/*/children/*", FieldKind::kReference},
    {"nodes/*/mesh", FieldKind::kReference},
    {"nodes/*/skin", FieldKind::kReference},
    {"nodes/*/matrix/*", FieldKind::kNumber},
    {"nodes/*/translation/*", FieldKind::kNumber},
    {"nodes/*/rotation/*", FieldKind::kNumber},
    {"nodes/*/scale/*", FieldKind::kNumber},
    {"nodes/*/weights/*", FieldKind::kNumber},
    {"skins/*/inverseBindMatrices", FieldKind::kReference},
    {"skins/*/joints/*", FieldKind::kReference},
    {"animations/*/channels/*/sampler", FieldKind::kReference, true},
    {"animations/*/channels/*/target/node", FieldKind::kReference},
    {"animations/*/channels/*/target/path", FieldKind::kText, true},
    {"animations/*/samplers/*/input", FieldKind::kReference, true},
    {"animations/*/samplers/*/output", FieldKind::kReference, true},
    {"animations/*/samplers/*/interpolation", FieldKind::kText},
    {"scenes/*/nodes/*", FieldKind::kReference},
};

struct KindRule {
  bool (*holds)(const Json& value);
  std::string_view expected;
};
constexpr std::string_view kFromZero = "a whole number from 0 on";
/// In the order of FieldKind.
constexpr std::array<KindRule, 5> kKinds = {
    {{[](const Json& value) { return value.is_number_unsigned(); }, kFromZero},
     {[](const Json& value) { return value.is_number_integer() && value != -1; }, kFromZero},
     {[](const Json& value) { return value.is_number(); }, "a number"},
     {[](const Json& value) { return value.is_string(); }, "a text"},
     {[](const Json& value) { return value.is_boolean(); }, "true or false"}}};

[[nodiscard]] const KindRule& ruleOf(FieldKind kind) {
  return kKinds[static_cast<std::size_t>(kind)];
}

/// "a text", "0.5": what stands where something else was expected.
[[nodiscard]] std::string found(const Json& value) {
  if (value.is_number()) return value.dump();
  return value.is_string() ? "a text" : value.is_structured() ? std::string("a list or object") : value.dump();
}

/// Follows one rule through the document. @return the first fault, or an empty text
[[nodiscard]] std::string faultOf(const Json& value, std::string_view path, const Rule& rule,
                                  const std::string& place) {
  const auto fault = [&](std::string_view expected) {
    return fmt::format("{}: {}, expected {}", place, found(value), expected);
  };
  if (path.empty()) return ruleOf(rule.kind).holds(value) ? std::string() : fault(ruleOf(rule.kind).expected);
  const std::size_t slash = std::min(path.find('/'), path.size());
  const std::string_view key = path.substr(0, slash);
  const std::string_view rest = path.substr(std::min(slash + 1, path.size()));
  if (key == "*") {
    if (!value.is_structured()) return fault("a list or object");
    std::size_t i = 0;
    for (auto it = value.begin(); it != value.end(); ++it, ++i) {
      // The place costs more than the check: it is written when something is wrong.
      if (rest.empty() && ruleOf(rule.kind).holds(*it)) continue;
      std::string wrong = faultOf(*it, rest, rule, place + "/" + (value.is_object() ? it.key() : std::to_string(i)));
      if (!wrong.empty()) return wrong;
    }
    return {};
  }
  if (!value.is_object()) return fault("an object");
  const auto member = value.find(key);
  if (member == value.end()) {
    return rest.empty() && rule.required
               ? fmt::format("{}: has no {}, expected {}", place, key, ruleOf(rule.kind).expected)
               : std::string();
  }
  return faultOf(*member, rest, rule, fmt::format("{}/{}", place, key));
}

/// Moves the constraints out of the nodes.
[[nodiscard]] std::vector<std::pair<std::size_t, Json>> takeNodeConstraints(Json& document) {
  std::vector<std::pair<std::size_t, Json>> taken;
  const auto nodes = document.find("nodes");
  if (nodes == document.end() || !nodes->is_array()) return taken;
  for (std::size_t n = 0; n < nodes->size(); ++n) {
    Json& node = (*nodes)[n];
    const auto extensions = node.is_object() ? node.find("extensions") : node.end();
    if (extensions == node.end() || !extensions->is_object()) continue;
    const auto constraint = extensions->find("VRMC_node_constraint");
    if (constraint != extensions->end()) taken.emplace_back(n, std::move(*constraint));
  }
  return taken;
}

/// The names of each mesh's morph targets, where most exporters put them: in the extras of the mesh or of its first
/// primitive.
[[nodiscard]] std::vector<std::vector<std::string>> targetNamesOf(const Json& document) {
  std::vector<std::vector<std::string>> all;
  const Json& meshes = listOf(document, "meshes");
  const Json::json_pointer inMesh("/extras/targetNames");
  const Json::json_pointer inPrimitive("/primitives/0/extras/targetNames");
  all.resize(meshes.size());
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const Json& mesh = meshes[m];
    if (!mesh.is_object()) continue;
    for (const Json::json_pointer& place : {inMesh, inPrimitive}) {
      if (!all[m].empty() || !mesh.contains(place) || !mesh.at(place).is_array()) continue;
      for (const Json& name : mesh.at(place)) {
        all[m].push_back(name.is_string() ? name.get<std::string>() : std::string());
      }
    }
  }
  return all;
}

/// Removes extensions and extras from every element: they are not used, and small ones would need much memory in
/// tinygltf.
void dropExtensions(Json& value) {
  if (value.is_object()) {
    value.erase("extensions");
    value.erase("extras");
  }
  if (!value.is_structured()) return;
  for (Json& child : value) dropExtensions(child);
}

/// Finds the bytes of each buffer.
class BufferFinder {
 public:
  BufferFinder(GltfDocument& document, const NamedFiles& files, std::optional<Bytes> binary)
      : document_(document), files_(files), binary_(binary) {}

  [[nodiscard]] Result<void> find(const Json& buffers) {
    if (!buffers.is_array()) return {};
    document_.buffers.reserve(buffers.size());
    for (std::size_t i = 0; i < buffers.size(); ++i) {
      const Json& buffer = buffers[i];
      const Json& length = memberOf(buffer, "byteLength");
      if (!length.is_number_unsigned()) return bad(i, "has no byteLength, expected a whole number");
      LORICA_TRY(Bytes bytes, bytesOf(buffer, i));
      const auto expected = length.get<std::uint64_t>();
      // An empty buffer is rejected when something reads from it.
      if (!bytes.empty() && bytes.size() < expected) {
        return bad(i,
                   fmt::format("byteLength is {}, but there are {} bytes", grouped(expected), grouped(bytes.size())));
      }
      document_.buffers.push_back(bytes.first(std::min<std::uint64_t>(expected, bytes.size())));
    }
    return {};
  }

 private:
  [[nodiscard]] Error bad(std::size_t buffer, const std::string& what) const {
    return badFormat("{}: buffer {}: {}", document_.name, buffer, what);
  }

  [[nodiscard]] Result<Bytes> bytesOf(const Json& buffer, std::size_t i) {
    const auto uri = buffer.find("uri");
    if (uri == buffer.end()) return i == 0 && binary_ ? *binary_ : Bytes{};
    if (!uri->is_string()) return bad(i, "its uri is not a string");
    const std::string& text = uri->get_ref<const std::string&>();
    if (const auto known = known_.find(text); known != known_.end()) return known->second;

    Result<std::string> content = isDataUri(text) ? decodeDataUri(text) : readNeighbour(text, i);
    if (!content) {
      if (isDataUri(text)) return bad(i, content.error().message);
      return content.error();
    }
    document_.owned.push_back(std::move(*content));
    const std::string& kept = document_.owned.back();
    document_.fileBytes += kept.size();
    const Bytes bytes = std::as_bytes(std::span(kept));
    known_.emplace(text, bytes);
    return bytes;
  }

  [[nodiscard]] Result<std::string> readNeighbour(const std::string& uri, std::size_t i) const {
    if (files_.folder.empty()) return bad(i, fmt::format("is in another file, '{}', which is not available here", uri));
    const Result<std::filesystem::path> file = files_.find(percentDecoded(uri));
    if (!file) return bad(i, file.error().message);
    return readFile(*file, NamedBy::kFile);
  }

  GltfDocument& document_;
  const NamedFiles& files_;
  std::optional<Bytes> binary_;
  std::map<std::string, Bytes> known_;  // one copy of data that several buffers refer to
};

[[nodiscard]] std::string oneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

}  // namespace

Result<GltfParts> splitGltf(Bytes bytes, const std::string& name) {
  GltfParts parts;
  if (bytes.size() >= 4 && textIn(bytes.first(4)) == "glTF") {
    LORICA_TRY(const GltfParts split, splitGlb(bytes, name));
    parts = split;
  } else {
    parts.json = textIn(bytes);
  }
  while (parts.json.ends_with('\0')) parts.json.remove_suffix(1);  // some writers pad with zeros
  return parts;
}

Result<void> checkGltfTypes(const Json& document, const std::string& name) {
  for (const Rule& rule : kRules) {
    std::string fault = faultOf(document, rule.path, rule, {});
    if (!fault.empty()) return badFormat("{}: {}", name, fault);
  }
  return {};
}

Result<GltfDocument> parseGltf(Bytes bytes, const std::string& name, const NamedFiles& files) {
  GltfDocument document;
  document.name = name;
  document.fileBytes = bytes.size();
  document.files = files;

  // 1. JSON and binary.
  LORICA_TRY(const GltfParts parts, splitGltf(bytes, name));
  LORICA_TRY(Json json, parseJson(parts.json, name));
  if (!json.is_object()) return badFormat("{}: its JSON is not an object, expected a glTF object", name);

  // 2. Content that is not supported.
  const std::string version = textOf(memberOf(json, "asset"), "version");
  if (!version.starts_with("2.")) {
    return Error{version.empty() ? ErrorCode::kBadFormat : ErrorCode::kUnsupported,
                 fmt::format("{}: glTF version '{}', expected 2.0", name, version)};
  }
  for (const auto& [key, value] : json.items()) {
    if (value.is_array() && value.size() > kMaxGltfElements) {
      return unsupported("{}: {} {}, expected at most {}", name, grouped(value.size()), key, grouped(kMaxGltfElements));
    }
  }

  // 3. Buffers, which are read here; tinygltf reads the rest that is needed.
  if (json.contains("buffers")) {
    BufferFinder finder(document, files, parts.binary);
    LORICA_TRY_DO(finder.find(json["buffers"]));
    json.erase("buffers");
  }
  LORICA_TRY_DO(decompressMeshes(json, document));
  document.extensions = Json::object();
  if (const auto extensions = json.find("extensions"); extensions != json.end() && extensions->is_object()) {
    document.extensions = std::move(*extensions);
  }
  document.look = Json::object();
  for (const char* list : {"images", "textures", "materials", "samplers"}) {
    if (const auto found = json.find(list); found != json.end()) document.look[list] = std::move(*found);
    json.erase(list);
  }
  json.erase("cameras");
  document.nodeConstraints = takeNodeConstraints(json);
  document.targetNames = targetNamesOf(json);
  dropExtensions(json);
  LORICA_TRY_DO(checkGltfTypes(json, name));

  std::string problem;
  std::string warning;
  try {
    tinygltf::TinyGLTF reader;
    const std::string text = json.dump();
    json.clear();
    if (!reader.LoadASCIIFromString(&document.model, &problem, &warning, text.data(),
                                    static_cast<unsigned int>(text.size()), "")) {
      return badFormat("{}: {}", name, oneLine(problem));
    }
  } catch (const std::exception& exception) {
    return badFormat("{}: {}", name, oneLine(exception.what()));
  }
  return document;
}

}  // namespace lorica
