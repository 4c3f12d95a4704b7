#pragma once

#include "acd/decomposition_file.h"
#include "geometry/text.h"
#include "prepare/body.h"
#include "prepare/read_motion.h"
#include "prepare/scenes.h"
#include "prepare/springs.h"
#include "session/recording/session_file.h"
#include "session/recording/session_recorder.h"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace lorica {

/// Says that a recording was found that a killed program left behind. @param found  its new name
void sayFound(const std::optional<std::filesystem::path>& found);

/// Rejects an unusable file name before any work.
[[nodiscard]] Result<void> checkRecord(const std::string& option, const std::string& file);

/// Description of an avatar for the recording of its session.
struct RecordedAs {
  std::string source;     ///< name of the source of motion
  bool poses = false;     ///< true = poses of bones, false = joints
  std::string character;  ///< as given by the user
  const CharacterOptions& reading;
  const MotionOptions& performing;
  const BodyOptions& body;
  std::optional<SpringChoice> springs;
  std::optional<std::string> clip = {};  ///< see PlaybackInput::ownClip
  bool stream = false;                   ///< whether the poses come with trust and expressions, see PoseSource
  Vec3 place = Vec3::Zero();             ///< see AvatarHeader
  double heading = 0.0;                  ///< see AvatarHeader
  std::optional<Vec3f> color = {};       ///< see AvatarHeader
};

/// An avatar of a session that is recorded.
struct RecordedAvatar {
  RecordedAs as;
  const Character& performer;
  const DecompositionFile& body;
};

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
                                             const std::string& decomposition);

/// Starts a recording. @param file   empty = none
/// @param scene  as given by the user
/// @return the recorder, which must watch the session and whose log the source needs; null if none was requested
[[nodiscard]] Result<std::shared_ptr<SessionRecorder>> startRecorder(const std::string& file,
                                                                     std::span<const RecordedAvatar> avatars,
                                                                     const std::string& scene, const World& world);

/// Finishes the recording. Does nothing without a recorder.
/// @param report,json  receive the number of recorded steps
[[nodiscard]] Result<void> finishRecorder(const std::shared_ptr<SessionRecorder>& recorder, const std::string& file,
                                          Report& report, nlohmann::ordered_json& json);

}  // namespace lorica
