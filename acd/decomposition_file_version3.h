#pragma once

#include "acd/byte_reader.h"
#include "acd/decomposition_file.h"

#include <string>

namespace lorica {

// What version 3 adds after all that version 2 has; in version 4 a part may also cover vertices that no part has.
// Internal: not installed.

/// Appends the training range and the cover promise, or that they are not known.
void appendVersion3(const DecompositionFile& content, std::string& payload);

/// Whether the cover has points that no part has.
[[nodiscard]] bool needsVersion4(const DecompositionFile& content);

/// Takes them. The decomposition is there already, and trusted.
void takeVersion3Or4(ByteReader& reader, std::uint32_t version, DecompositionFile& content);

}  // namespace lorica
