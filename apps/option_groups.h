#pragma once

#include "acd/decompose.h"
#include "apps/command_line.h"
#include "apps/report.h"
#include "player/follow_camera.h"
#include "player/pose_output.h"
#include "player/snapshots.h"
#include "prepare/cameras.h"
#include "prepare/cast.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// --map, --body-resolution, --walls, --thickness, --expression and --hide.
void addCharacterOptions(CommandLine& app, CharacterOptions& options);
/// --hide NAME, which may be repeated.
void addHideOption(CommandLine& app, std::vector<std::string>& hidden);
/// --texture-size, for commands that draw.
void addTextureOption(CommandLine& app, int& textureSize);
/// --format, --person, --clip, --rest, --sender: how a motion is read.
void addReadingOptions(CommandLine& app, MotionOptions& options);
/// --mirror, --upper-body, --smooth, --min-cutoff, --beta: how it is processed.
void addPlayingOptions(CommandLine& app, MotionOptions& options);
/// Whether one of --smooth, --min-cutoff and --beta was given.
[[nodiscard]] bool smoothingGiven(const CommandLine& app);
/// --inject: simulated tracking faults.
void addFaultOption(CommandLine& app, MotionOptions& options);
/// MOTION, --character, and the options for reading and processing both.
void addMotionOptions(CommandLine& app, CastRequest& options);
/// --sender FILE.vrm
void addSenderOption(CommandLine& app, std::string& file);
/// --decomposition, --cover, --hull-vertices.
void addBodyOptions(CommandLine& app, BodyOptions& options);
/// --cover: `exact`, or a length above zero [m].
Option* addCover(CommandLine& app, std::optional<double>& tolerance, const std::string& description);
/// --body: auto, never or always.
void addBodyOption(CommandLine& app, std::string& body);
void addPresetOption(CommandLine& app, std::string& preset);
/// @param name  as checked by the option
[[nodiscard]] DecomposePreset presetNamed(const std::string& name);
/// --walls and --thickness.
void addWallOptions(CommandLine& app, CharacterOptions& options);
/// @param name  one of these
[[nodiscard]] BodyChoice bodyChoice(const std::string& name);
/// --scene.
void addSceneOption(CommandLine& app, std::string& scene);
/// --springs. @param mode  receives its value; empty = not given
void addSpringOption(CommandLine& app, std::string& mode);
/// --expression NAME=WEIGHT, which may be repeated.
void addExpressionOption(CommandLine& app, std::vector<std::string>& expressions);
/// --record FILE.lsession.
void addRecordOption(CommandLine& app, std::string& file);
/// --device, --driver, --virtual, --motion.
void addDepthOptions(CommandLine& app, DepthOptions& options);
/// --lower-body and --three-point. @return the first
Option* addWearerOptions(CommandLine& app, LiveRequest& live);
/// --vmc and --delay. @return --vmc
Option* addVmcInputOptions(CommandLine& app, VmcInputOptions& options);
/// --vmc-out HOST:PORT, --vmc-bones NAME,..., --vrchat HOST[:PORT]
void addPoseOutputOptions(CommandLine& app, PoseOutputOptions& options);
/// --events FILE|-.
void addEventsOption(CommandLine& app, std::string& to);
/// @param window  the option --window, which these exclude
void addSnapshotOptions(CommandLine& app, SnapshotOptions& options, Option* window);
void addCameraOptions(CommandLine& app, CameraOptions& options);
/// --size and --background.
void addLookOptions(CommandLine& app, SnapshotOptions& options);

}  // namespace lorica
