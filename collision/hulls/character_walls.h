#pragma once

#include "collision/hulls/subject.h"
#include "skinning/body/closed_body.h"

#include <functional>

namespace lorica {

/// Makes the body of the rest of a character.
using MakeRest = std::function<Result<ClosedBody>(const Character& rest)>;

/// The body of a character with thin walls of its bind pose that move with its bones: of those pieces of which
/// makeWalls() would make them if it were a mesh, if they are large, see kWorthAWall. Where there are none, and with
/// WallChoice::kSolid in the options, it is the body of the whole. Without a choice too, unless all of it is sheets,
/// such as a flag: then all of it becomes walls.
/// @param options  walls, thickness
[[nodiscard]] Result<ClosedBody> bodyWithWalls(const CharacterFile& file, const CharacterOptions& options,
                                               const MakeRest& makeRest);

}  // namespace lorica
