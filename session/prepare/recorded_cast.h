#pragma once

#include "session/prepare/cast.h"
#include "session/prepare/scenes.h"
#include "session/prepare/subject.h"
#include "session/recording/session_file.h"

#include <cstddef>
#include <memory>
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

/// A recorded session that runs again.
struct RecordedRequest {
  std::string file;           ///< .lsession
  std::string character;      ///< of the first avatar; empty = as recorded
  std::string decomposition;  ///< of the first avatar; empty = as recorded
  bool drawn = false;         ///< see CharacterOptions
  int textureSize = 0;        ///< see CharacterOptions
};

/// The cast of a recorded session.
struct RecordedCast {
  Cast cast;
  std::shared_ptr<const SessionFile> session;
  SceneText scene;

  /// The world at the start of the recording.
  [[nodiscard]] Result<World> world(Host& host) const { return worldOf(scene, session->header.scene, host); }
};

/// Reads the session and what it names; checks that characters, decompositions and covers are the recorded ones.
[[nodiscard]] Result<RecordedCast> prepareRecordedCast(const RecordedRequest& request, Host& host);

}  // namespace lorica
