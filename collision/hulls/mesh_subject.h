#pragma once

#include "collision/hulls/host.h"
#include "collision/hulls/subject.h"

#include <string>
#include <vector>

namespace lorica {

/// A subject of a mesh that is no character: repaired, see repairSmallFaults(); if that is not enough and the options
/// allow it, with a closed body instead of its own surface.
/// @param name     for the subject and for errors
/// @param mesh     as the file has it
/// @param options  body and bodyResolution; the latter in the mesh's unit
/// @return the subject; its mesh is not closed if no body may be made, which is left to the check; or an error
[[nodiscard]] Result<Subject> meshSubject(const std::string& name, TriMesh mesh, const CharacterOptions& options,
                                          Host& host);

/// The length in which concavities of a subject are given, see concavityUnit(): of the file's surface.
[[nodiscard]] double concavityUnitOf(const Subject& subject);

/// The vertices that the hulls of a subject must hold: those of a mesh's surface and those that it stands for; all
/// vertices of a character.
[[nodiscard]] std::vector<VertexIndex> verticesToHold(const Subject& subject);

}  // namespace lorica
