#pragma once

#include "collision/hulls/host.h"
#include "collision/hulls/subject.h"
#include "geometry/result.h"
#include "skinning/import/character_file.h"
#include "skinning/morphs/expressions.h"

#include <span>
#include <string>
#include <vector>

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

/// CharacterFile::format of a mesh in several poses.
inline constexpr const char* kSequence = "mesh sequence";

/// Reads what kindOf() calls a character: its file, see readCharacterFile(), or a mesh in several poses, see
/// readMeshSequence().
/// @param hidden  see CharacterFileSettings
[[nodiscard]] Result<CharacterFile> readPlayed(const std::string& input, Host& host,
                                               std::vector<std::string> hidden = {});

/// The weight of each expression of a character.
/// @param given  "Joy=1" and the like; several weights of one expression: the last counts
/// @param input  name of the character, for messages
/// @return one weight for each expression; or an error that lists the known ones, or says what a weight may be
[[nodiscard]] Result<std::vector<float>> chosenExpressions(const Expressions& expressions,
                                                           std::span<const std::string> given,
                                                           const std::string& input);

}  // namespace lorica
