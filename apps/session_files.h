#pragma once

#include "acd/decomposition_file.h"
#include "apps/body_choice.h"
#include "apps/command_line.h"
#include "apps/motions.h"
#include "apps/report.h"
#include "apps/spring_options.h"
#include "session/session_recorder.h"

#include <nlohmann/json_fwd.hpp>

#include <memory>
#include <optional>
#include <string>

namespace lorica {

/// --record FILE.lsession.
void addRecordOption(CommandLine& app, std::string& file);

/// Rejects an unusable file name before any work.
[[nodiscard]] Result<void> checkRecord(const std::string& option, const std::string& file);

/// Description of a session for its recording.
struct RecordedAs {
  std::string source;     ///< name of the source of motion
  bool poses = false;     ///< true = poses of bones, false = joints
  std::string character;  ///< as given by the user
  const CharacterOptions& reading;
  const MotionOptions& performing;
  const BodyOptions& body;
  std::string scene;  ///< as given by the user
  std::optional<SpringChoice> springs;
};

/// Starts a recording. @param file  empty = none
/// @return the recorder, which must watch the session and whose log the source needs; null if none was requested
[[nodiscard]] Result<std::shared_ptr<SessionRecorder>> startRecorder(const std::string& file, const RecordedAs& as,
                                                                     const Character& character,
                                                                     const DecompositionFile& body, const World& world);

/// Finishes the recording. Does nothing without a recorder.
/// @param report,json  receive the number of recorded steps
[[nodiscard]] Result<void> finishRecorder(const std::shared_ptr<SessionRecorder>& recorder, const std::string& file,
                                          Report& report, nlohmann::ordered_json& json);

}  // namespace lorica
