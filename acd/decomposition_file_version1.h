#pragma once

#include "acd/byte_reader.h"
#include "acd/decomposition_file.h"

namespace lorica {

/// Takes the payload of a file of version 1, which nobody writes any more. Internal: not installed.
/// @return the content as far as the reader succeeded: see ByteReader::ok
[[nodiscard]] DecompositionFile takeVersion1(ByteReader& reader);

/// What all versions begin with alike: from the source's name to the mesh's triangle count.
void takeDescription(ByteReader& reader, DecompositionFile& content);

}  // namespace lorica
