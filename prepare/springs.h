#pragma once

#include "prepare/subject.h"
#include "session/session.h"

#include <optional>
#include <string>

namespace lorica {

/// The springs and constraints of a character and what they do.
struct SpringChoice {
  SpringBones springs;
  SpringMode mode = SpringMode::kFile;
};

/// @param mode  as given; empty = usualSpringMode()
/// @return none if there is nothing to move: neither springs, or the mode is none, nor constraints
[[nodiscard]] std::optional<SpringChoice> chooseSprings(const Subject& subject, const std::string& mode);

}  // namespace lorica
