#pragma once

#include "apps/command_line.h"
#include "apps/inputs.h"
#include "apps/motions.h"

#include <string>

namespace lorica {

/// What the command line says of who plays what.
struct CastOptions {
  std::string motion;     ///< empty = the character's own clip
  std::string character;  ///< empty = the mannequin, or the motion's file where that is a character with a surface
  CharacterOptions reading;
  MotionOptions performing;
};

/// MOTION, --character, and how both are read and played.
void addCastOptions(CommandLine& app, CastOptions& options);

/// Who plays what.
struct Cast {
  Subject subject;  ///< with a character
  Motion motion;
};

/// A character that is the motion's file performs its own clip. Without a motion so does the one named.
[[nodiscard]] Result<Cast> readCast(const CastOptions& options);

}  // namespace lorica
