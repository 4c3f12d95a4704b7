#pragma once

#include "geometry/named_file.h"
#include "geometry/result.h"

#include <tiny_gltf.h>
#include <nlohmann/json.hpp>

#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lorica {

/// Whether what is read of a glTF document has the JSON types that glTF prescribes, and what may not be missing is
/// there.
///
/// tinygltf takes an index that is a text, a fraction or -1 for one that is not given, and so would read another file
/// than the one that was meant. https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html#properties-reference
/// @param document  an object, without what is not read or read elsewhere: materials, images, buffers, names
/// @param name      of the file, for messages
/// @return the place of the first fault, what was found and what was expected
[[nodiscard]] Result<void> checkGltfTypes(const nlohmann::json& document, const std::string& name);

/// A parsed glTF 2.0 file with its buffers. The model's indices are not checked.
struct GltfDocument {
  std::string name;                                   ///< of the file, for messages
  tinygltf::Model model;                              ///< without buffers, images, materials, extras and extensions
  nlohmann::json extensions;                          ///< of the whole file, such as VRM; an object
  std::vector<std::vector<std::string>> targetNames;  ///< of each mesh's morph targets, as far as they have names
  /// VRMC_node_constraint of each node that has one, nodes ascending
  std::vector<std::pair<std::size_t, nlohmann::json>> nodeConstraints;
  nlohmann::json look;                              ///< the members materials, textures, images, samplers; an object
  NamedFiles files;                                 ///< where other files are; an empty folder: they are not read
  std::vector<std::span<const std::byte>> buffers;  ///< no longer than declared; into `bytes` or `owned`
  std::deque<std::string> owned;
  std::size_t fileBytes = 0;  ///< of the file and everything that it embeds or refers to
};

/// Decompresses meshes: EXT_meshopt_compression of buffer views, with its filters, and KHR_draco_mesh_compression of
/// primitives. Afterwards the document's views, accessors and primitives refer to plain data in new buffers.
///
/// All of it together may have at most 64 bytes for each byte of the file, or 16 MB if that is more: a few bytes can
/// claim any number of vertices.
/// @param json  the document with its buffers found; written
/// @return or what is broken, or compressed in a way that the installed decoders do not know
[[nodiscard]] Result<void> decompressMeshes(nlohmann::json& json, GltfDocument& document);

/// The two parts of a GLB, or the text of a .gltf alone. Both refer to the bytes of the file.
struct GltfParts {
  std::string_view json;
  std::optional<std::span<const std::byte>> binary;
};

/// Splits a .glb, .vrm or .gltf, detected from the content. The JSON is not parsed.
[[nodiscard]] Result<GltfParts> splitGltf(std::span<const std::byte> bytes, const std::string& name);

/// Reads a .gltf, .glb or .vrm. Only what is needed is passed to tinygltf, so images may be broken or absent.
///
/// At most 100,000 elements of a kind and 64 levels of JSON are accepted.
/// @param bytes   must outlive the document
/// @param files   where other files are searched; an empty folder: they are not read
[[nodiscard]] Result<GltfDocument> parseGltf(std::span<const std::byte> bytes, const std::string& name,
                                             const NamedFiles& files);

}  // namespace lorica
