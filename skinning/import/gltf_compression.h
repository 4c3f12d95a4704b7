#pragma once

#include "skinning/import/gltf_document.h"

namespace lorica {

/// Decompresses meshes: EXT_meshopt_compression of buffer views, with its filters, and KHR_draco_mesh_compression of
/// primitives. Afterwards the document's views, accessors and primitives refer to plain data in new buffers.
///
/// All of it together may have at most 64 bytes for each byte of the file, or 16 MB if that is more: a few bytes can
/// claim any number of vertices.
/// @param json  the document with its buffers found; written
/// @return or what is broken, or compressed in a way that the installed decoders do not know
[[nodiscard]] Result<void> decompressMeshes(nlohmann::json& json, GltfDocument& document);

}  // namespace lorica
