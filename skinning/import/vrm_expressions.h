#pragma once

#include "skinning/import/file_scene.h"

#include <nlohmann/json_fwd.hpp>

namespace lorica {

/// Reads expressions and gaze of VRM 0.x (blendShapeMaster, firstPerson) or 1.0 (expressions, lookAt). In a file
/// without VRM data every morph target becomes an expression by its own name; targets of the same name become one.
/// https://github.com/vrm-c/vrm-specification: 0.0/README.md, VRMC_vrm-1.0/expressions.md and lookAt.md
///
/// Binds to morph targets and materials that do not exist are skipped, with a note.
/// @param extensions  those of the whole file, an object
/// @param scene       its morph targets and materials are read; expressions, gaze and notes are written
void readExpressions(const nlohmann::json& extensions, FileScene& scene);

}  // namespace lorica
