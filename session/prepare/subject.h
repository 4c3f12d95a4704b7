#pragma once

#include "collision/hulls/host.h"
#include "collision/hulls/subject.h"
#include "geometry/result.h"

#include <string>

namespace lorica {

struct MeshSequence;

/// Reads INPUT of `decompose` and `info`: the name of a built-in character, a character file, a mesh in several
/// poses (see readMeshSequence()), or else a mesh file. A
/// character file with neither skin nor clips is a mesh. A mesh is repaired, or gets a closed body, see meshSubject();
/// a body is made for a character.
[[nodiscard]] Result<Subject> readSubject(const std::string& input, const CharacterOptions& options, Host& host);

/// The same of a mesh in several poses from elsewhere.
[[nodiscard]] Result<Subject> sequenceSubject(MeshSequence sequence, const CharacterOptions& options, Host& host);

/// CharacterOptions::suits for a person before a camera, whose joints the character must be able to follow.
[[nodiscard]] Result<void> followsPerson(const CharacterFile& file);

/// A character by its name or file, or an error that says what is expected.
[[nodiscard]] Result<Subject> readCharacter(const std::string& nameOrFile, const CharacterOptions& options, Host& host);

}  // namespace lorica
