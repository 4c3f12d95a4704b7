#pragma once

#include "acd/byte_reader.h"
#include "acd/decomposition_file.h"

#include <string>

namespace lorica {

// What version 3 adds after all that version 2 has. Internal: not installed.

/// Appends the training range and the cover promise, or that they are not known.
void appendVersion3(const DecompositionFile& content, std::string& payload);

/// Takes them. The decomposition is there already, and trusted.
void takeVersion3(ByteReader& reader, DecompositionFile& content);

}  // namespace lorica
