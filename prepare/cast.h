#pragma once

#include "acd/decomposition_file.h"
#include "prepare/body.h"
#include "prepare/playback_input.h"
#include "prepare/session_files.h"
#include "prepare/springs.h"
#include "session/scenes/hit_counter.h"
#include "session/session.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

struct WindowTreatment;

/// An avatar of a run, set up by the options of the command line: what it is and what it performs.
struct CastMember {
  PlaybackInputOptions options;
  PlaybackInput input;
  DecompositionFile body;
  std::optional<SpringChoice> springs;
  Vec3 place = Vec3::Zero();   ///< of the motion's origin [m]
  double heading = 0.0;        ///< by which the motion is turned around the vertical [degrees]
  std::optional<Vec3f> color;  ///< see StageAvatar

  [[nodiscard]] const Character& character() const { return *input.subject.character; }
  [[nodiscard]] const Motion& motion() const { return input.motion; }
};

/// Maximum number of avatars that the command line sets up.
inline constexpr std::size_t kMaxCast = 64;

/// The parts of a text between commas; a file whose name has commas is one.
[[nodiscard]] std::vector<std::string> namesIn(const std::string& text);

/// The files that the options name, which no output may overwrite.
[[nodiscard]] std::vector<std::filesystem::path> filesOf(const PlaybackInputOptions& input, const BodyOptions& body);

/// The avatars of a run and their world.
struct OpenedCast {
  World world;
  std::vector<HitTarget> targets;  ///< of the scene
  std::vector<CastMember> avatars;
};

/// Opens the scene and reads the avatars: those that the options name, one for each motion ("walk,wave"), side by side,
/// 1.2 m apart, all with one character or each with its own; else those of the scene.
/// @param scene  as given by the user, see openScene()
[[nodiscard]] Result<OpenedCast> openCast(const PlaybackInputOptions& options, const BodyOptions& body,
                                          const std::string& scene, int threads);

/// startRecorder() for a cast.
[[nodiscard]] Result<std::shared_ptr<SessionRecorder>> startRecorder(const std::string& file,
                                                                     std::span<const CastMember> cast,
                                                                     const BodyOptions& body, const std::string& scene,
                                                                     const World& world);

/// @param recorder  gets what the sources give; null = none
[[nodiscard]] Result<Session> startSession(std::span<const CastMember> cast,
                                           const std::shared_ptr<SessionRecorder>& recorder, World world);

/// New sources for a session of the cast, from their start.
[[nodiscard]] Result<std::vector<std::unique_ptr<PoseSource>>> sourcesOf(std::span<const CastMember> cast,
                                                                         const WindowTreatment& treatment);

/// "walk, wave and jump"
[[nodiscard]] std::string listed(std::span<const std::string> names);

/// "walk" or "walk and wave".
[[nodiscard]] std::string motionsOf(std::span<const CastMember> cast);
/// The duration of the longest motion [s].
[[nodiscard]] double secondsOf(std::span<const CastMember> cast);

}  // namespace lorica
