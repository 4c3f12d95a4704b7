#pragma once

#include "prepare/scenes.h"
#include "prepare/subject.h"
#include "session/recording/session_file.h"

#include <cstddef>
#include <string>

namespace lorica {

/// Whether it is the name of what ships, such as "mannequin" or "bowling", and no file.
[[nodiscard]] bool isShippedName(const std::string& name);

/// A name for a session file to hold: relative to the session's folder, so that both can be moved together.
[[nodiscard]] std::string nameFrom(const std::string& session, const std::string& file);

/// The files that a recorded session names, where this machine has them. Names of what ships stay as they are; the
/// others follow the rule of NamedFiles, from the folder of the session.
struct SessionInputs {
  std::string character;
  std::string boneMap;        ///< empty = none
  std::string decomposition;  ///< empty = the default one
  SceneText scene;
};

/// @param session    file of the session
/// @param avatar     index of the avatar whose files are meant
/// @param character  replaces the recorded name and is not checked; empty = as recorded. So does `decomposition`
/// @return the files; or an error with the name of the first that is not allowed, and the option that gives another
[[nodiscard]] Result<SessionInputs> inputsOf(const SessionFile& recorded, const std::string& session,
                                             std::size_t avatar, const std::string& character,
                                             const std::string& decomposition, const Host& host);

/// How the recorded character was read.
[[nodiscard]] Result<CharacterOptions> readingOf(const SessionInputs& inputs, const AvatarRecord& record);

}  // namespace lorica
