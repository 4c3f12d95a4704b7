#pragma once

#include "acd/decomposition.h"
#include "acd/hull_cover.h"
#include "prepare/cover_choice.h"
#include "prepare/host.h"
#include "skinning/character.h"

#include <optional>
#include <string>

namespace lorica {

/// Rejects, before any work, a contradictory request or a tolerance that is out of range.
[[nodiscard]] Result<void> checkCover(const CoverRequest& request, const Character& character);

/// chooseCover() as a task of the host. Exact if nothing was requested.
/// @param decomposition  made from the character's mesh
[[nodiscard]] Result<HullCover> chooseCoverWithProgress(const Character& character, const Decomposition& decomposition,
                                                        const CoverPoses& poses, const CoverRequest& request,
                                                        Host& host);

/// "--cover 0.002 --hull-vertices 64"
[[nodiscard]] std::string asTyped(const CoverRequest& request);

}  // namespace lorica
