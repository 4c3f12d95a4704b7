#pragma once

#include "geometry/result.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

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

}  // namespace lorica
