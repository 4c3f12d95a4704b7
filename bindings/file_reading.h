#pragma once

#include "skinning/import/character_file.h"

namespace lorica {

/// How files of strangers are read: FBX and COLLADA in a process of their own, by the program lorica_character_reader,
/// which lies where this library's modules do. If it is missing, reading these formats fails with its name.
[[nodiscard]] CharacterFileSettings fileReading();

}  // namespace lorica
