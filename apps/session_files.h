#pragma once

#include "acd/decomposition_file.h"
#include "apps/body_choice.h"
#include "apps/command_line.h"
#include "apps/motions.h"
#include "apps/report.h"
#include "session/session_recorder.h"

#include <nlohmann/json_fwd.hpp>

#include <memory>
#include <string>

namespace lorica {

/// --record FILE.lsession.
void addRecordOption(CommandLine& app, std::string& file);

/// Refuses a file that cannot be, before any work.
[[nodiscard]] Result<void> checkRecord(const std::string& option, const std::string& file);

/// What a command is about to run, as a recorded session names it.
struct RecordedAs {
  std::string source;     ///< what moves the character
  bool poses = false;     ///< its bones, or joints that a sensor gave
  std::string character;  ///< as it was given
  const CharacterOptions& reading;
  const MotionOptions& performing;
  const BodyOptions& body;
  std::string scene;  ///< as it was given
};

/// Begins a recording. @param file  empty = none
/// @return the recorder, which has to watch the session and whose log the source needs; null where none was asked for
[[nodiscard]] Result<std::shared_ptr<SessionRecorder>> startRecorder(const std::string& file, const RecordedAs& as,
                                                                     const Character& character,
                                                                     const DecompositionFile& body, const World& world);

/// Ends it. Nothing happens without a recorder.
/// @param report,json  told what was recorded
[[nodiscard]] Result<void> finishRecorder(const std::shared_ptr<SessionRecorder>& recorder, const std::string& file,
                                          Report& report, nlohmann::ordered_json& json);

}  // namespace lorica
