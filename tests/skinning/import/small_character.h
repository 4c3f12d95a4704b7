#pragma once

#include "skinning/import/character_file.h"
#include "tests/skinning/import/glb_writer.h"

namespace lorica::test {

/// A box 0.4 x 2 x 0.4 m on the floor, in two halves, each attached to one of two bones 1 m apart; a clip rotates the
/// upper one. Nodes: 0 "lower", 1 "upper" (its child), 2 "box" with mesh 0 and skin 0. Accessors, in this order:
/// 0 positions, 1 indices, 2 joints, 3 weights, 4 inverse bind matrices, 5 times, 6 rotations.
[[nodiscard]] GlbWriter smallCharacter();

[[nodiscard]] Result<CharacterFile> parsed(const GlbWriter& writer);

/// How many notes contain a text.
[[nodiscard]] int notesWith(const CharacterFile& file, const std::string& part);
[[nodiscard]] bool hasNote(const CharacterFile& file, const std::string& part);

}  // namespace lorica::test
