#pragma once

#include "acd/decompose.h"
#include "apps/options.h"
#include "apps/report.h"
#include "session/prepare/cameras.h"
#include "session/prepare/cast.h"
#include "viewer/player/follow_camera.h"
#include "viewer/player/run.h"
#include "viewer/player/snapshots.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

/// --map, --body-resolution, --walls, --thickness, --expression and --hide.
void addCharacterOptions(CLI::App& app, CharacterOptions& options);
/// --hide NAME, which may be repeated.
void addHideOption(CLI::App& app, std::vector<std::string>& hidden);
/// --texture-size, for commands that draw.
void addTextureOption(CLI::App& app, int& textureSize);
/// --format, --person, --clip, --rest, --sender: how a motion is read.
void addReadingOptions(CLI::App& app, MotionOptions& options);
/// --mirror, --upper-body, --smooth, --min-cutoff, --beta: how it is processed.
void addPlayingOptions(CLI::App& app, MotionOptions& options);
/// --inject: simulated tracking faults.
void addFaultOption(CLI::App& app, MotionOptions& options);
/// MOTION, --character, and the options for reading and processing both.
void addMotionOptions(CLI::App& app, CastRequest& options);
/// --sender FILE.vrm
void addSenderOption(CLI::App& app, std::string& file);
/// --decomposition, --cover, --hull-vertices.
void addBodyOptions(CLI::App& app, BodyOptions& options);
/// --cover: `exact`, or a length above zero [m].
CLI::Option* addCover(CLI::App& app, std::optional<double>& tolerance, const std::string& description);
/// --hull-planes, of hulls in one pose.
void addHullPlanes(CLI::App& app, int& planes);
/// --body: auto, never or always.
void addBodyOption(CLI::App& app, std::string& body);
/// A check that accepts the names of engines.
[[nodiscard]] CLI::Validator anEngine();
void addPresetOption(CLI::App& app, std::string& preset);
/// @param name  as checked by the option
[[nodiscard]] DecomposePreset presetNamed(const std::string& name);
/// --walls and --thickness.
void addWallOptions(CLI::App& app, CharacterOptions& options);
/// @param name  one of these
[[nodiscard]] BodyChoice bodyChoice(const std::string& name);
/// --scene. @param scene  becomes what openScene() takes
/// @param usual  what the help says of a command without it
/// @return the option, which tells whether props were asked for
CLI::Option* addSceneOption(CLI::App& app, std::string& scene, const std::string& usual = "demo");
/// --springs. @param mode  receives its value; empty = not given
void addSpringOption(CLI::App& app, std::string& mode);
/// --record FILE.lsession and --frames.
void addRecordOptions(CLI::App& app, RunSetting& run);
/// --device, --driver, --virtual, --motion.
void addDepthOptions(CLI::App& app, DepthOptions& options);
/// --lower-body and --three-point. @return the first
CLI::Option* addWearerOptions(CLI::App& app, LiveRequest& live);
/// --vmc and --delay. @return --vmc
CLI::Option* addVmcInputOptions(CLI::App& app, VmcInputOptions& options);
/// --vmc-out HOST:PORT, --vmc-bones NAME,..., --vrchat HOST[:PORT], --vmt HOST[:PORT], --trackers NAME,..., --events
/// FILE|-
void addOutputOptions(CLI::App& app, RunSetting& run);
/// @param window  the option --window, which these exclude
void addSnapshotOptions(CLI::App& app, SnapshotOptions& options, CLI::Option* window);
void addCameraOptions(CLI::App& app, CameraOptions& options);
/// --size and --background.
void addLookOptions(CLI::App& app, SnapshotOptions& options);

}  // namespace lorica
