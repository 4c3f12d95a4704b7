#pragma once

#include "prepare/read_motion.h"
#include "prepare/subject.h"

#include <optional>
#include <string>

namespace lorica {

/// Options that select a motion and a character.
struct PlaybackInputOptions {
  std::string motion;     ///< empty = the character's own clip
  std::string character;  ///< empty = the mannequin, or the motion's file if it is a character with a surface
  CharacterOptions reading;
  MotionOptions performing;
  std::string springs;  ///< see chooseSprings()
};

/// A character and the motion that it performs.
struct PlaybackInput {
  Subject subject;  ///< with a character
  Motion motion;
  std::optional<std::string> ownClip = {};  ///< the character's own clip that it performs, as given; see findClip()
};

/// If the motion file is a character, or only a character is given, it performs its own clip.
[[nodiscard]] Result<PlaybackInput> readPlaybackInput(const PlaybackInputOptions& options);
/// The same with a motion that was read.
[[nodiscard]] Result<PlaybackInput> readPlaybackInput(const PlaybackInputOptions& options, Motion motion);

}  // namespace lorica
