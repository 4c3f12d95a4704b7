#pragma once

#include "geometry/result.h"
#include "skinning/morphs/expressions.h"

#include <span>
#include <string>
#include <vector>

namespace lorica {

/// The weight of each expression of a character.
/// @param given  "Joy=1" and the like; several weights of one expression: the last counts
/// @param input  name of the character, for messages
/// @return one weight for each expression; or an error that lists the known ones, or says what a weight may be
[[nodiscard]] Result<std::vector<float>> chosenExpressions(const Expressions& expressions,
                                                           std::span<const std::string> given,
                                                           const std::string& input);

}  // namespace lorica
