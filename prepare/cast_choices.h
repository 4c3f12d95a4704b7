#pragma once

#include "prepare/cast.h"

#include <string>
#include <vector>

namespace lorica {

/// What else the file of a cast's motion holds: other clips of a character file, other people of a recording.
struct CastChoices {
  std::vector<std::string> clips;   ///< empty = there is at most one
  int clip = 0;                     ///< index of the played one
  std::vector<std::string> people;  ///< their numbers; empty = there is at most one
  int person = 0;                   ///< index of the one who is followed; -1 = everyone
  bool everyone = false;            ///< everyone may be followed at once
};

/// @param input  that the cast was opened from
[[nodiscard]] CastChoices choicesOf(const PlaybackInputOptions& input, const OpenedCast& cast);

}  // namespace lorica
