#pragma once

#include "geometry/result.h"

#include <tiny_gltf.h>
#include <nlohmann/json.hpp>

#include <cstddef>
#include <deque>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// A glTF 2.0 file taken apart, with its buffers found. Of the model's indices none is checked.
struct GltfDocument {
  std::string name;                                 ///< of the file, for sentences
  tinygltf::Model model;                            ///< without buffers, images, materials, extras and extensions
  nlohmann::json extensions;                        ///< those of the whole file, such as VRM; an object
  std::vector<std::span<const std::byte>> buffers;  ///< no longer than the file says; into `bytes` or `owned`
  std::deque<std::string> owned;
  std::size_t fileBytes = 0;  ///< of the file and all that it draws in
};

/// Reads a .gltf, .glb or .vrm. Nothing that is not needed reaches tinygltf, so that images may be broken or absent.
///
/// At most 100,000 elements of a kind and 64 levels of JSON are read.
/// @param bytes   must outlive the document
/// @param folder  where other files are looked for; empty: there are none
[[nodiscard]] Result<GltfDocument> parseGltf(std::span<const std::byte> bytes, const std::string& name,
                                             const std::filesystem::path& folder);

}  // namespace lorica
