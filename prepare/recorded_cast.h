#pragma once

#include "prepare/cast.h"
#include "prepare/scenes.h"
#include "session/recording/session_file.h"

#include <memory>
#include <string>

namespace lorica {

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
