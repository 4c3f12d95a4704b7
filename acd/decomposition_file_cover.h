#pragma once

#include "acd/decomposition_file.h"
#include "geometry/byte_reader.h"

#include <string>

namespace lorica {

// The end of a .lorica file: training range and hull cover. Internal: not installed.

/// Appends both, or that they are not known.
void appendTrainingAndCover(const DecompositionFile& content, std::string& payload);

/// Reads both. The decomposition has been read and checked before.
void takeTrainingAndCover(ByteReader& reader, DecompositionFile& content);

}  // namespace lorica
