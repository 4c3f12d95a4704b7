#pragma once

#include "acd/decomposition_file.h"
#include "capture/tracking/live_joints.h"
#include "player/playback.h"
#include "player/pose_output.h"
#include "player/snapshots.h"
#include "prepare/body.h"
#include "prepare/cameras.h"
#include "prepare/read_motion.h"
#include "prepare/session_files.h"
#include "prepare/springs.h"
#include "prepare/subject.h"
#include "prepare/treatment.h"
#include "prepare/vmc_input.h"
#include "session/session.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// Maximum number of people that a camera's tracker follows.
inline constexpr std::size_t kMaxPeople = 6;

/// The options of `lorica live`.
struct LiveOptions {
  DepthOptions depth;
  std::string nite;     // library; empty = Lorica's own tracker
  VmcInputOptions vmc;  // instead of a camera
  PoseOutputOptions out;
  std::string events;  // file or -; empty = none
  int person = 0;
  int people = 1;                       // avatars
  std::string character = "mannequin";  // or one for each, separated by commas
  CharacterOptions reading;
  std::string springs;  // see chooseSprings()
  MotionOptions performing;
  BodyOptions body;
  std::string scene;
  SnapshotOptions pictures;
  PlaybackOptions limit;
  std::string record;  // file; empty = none
  bool window = false;
  bool headless = false;
};

/// Whom the characters of a live session follow.
struct Performer {
  std::vector<std::shared_ptr<SkeletonSource>> joints;  ///< of each avatar; empty if a program sends
  const LiveJoints* tracked;                            ///< the first; null if NiTE 2 tracks or a program sends
  std::vector<VmcInput> vmc;                            ///< of each avatar; empty without a program that sends
  std::string name;
};

/// How many avatars there are: one for each person or for each program that sends.
[[nodiscard]] std::size_t avatarsOf(const LiveOptions& options);

/// The options of each program that sends; empty without --vmc.
[[nodiscard]] std::vector<VmcInputOptions> sendersOf(const LiveOptions& options);

/// Rejects options of the streams that cannot be, and too many people.
[[nodiscard]] Result<void> checkPeople(const LiveOptions& options);

/// The world of a scene in which avatars follow people; warns of the scene's own avatars, which do not perform.
[[nodiscard]] Result<World> openSceneForPeople(const std::string& scene);

/// Opens the camera or the streams.
[[nodiscard]] Result<Performer> openPerformer(const LiveOptions& options);

/// A character that follows somebody.
struct Follower {
  std::string name;  ///< as given
  Subject subject;
  DecompositionFile body;
  std::optional<SpringChoice> springs;

  [[nodiscard]] const Character& character() const { return *subject.character; }
};

/// Reads the characters, in the order of coming.
/// @param drawn  whether pictures are drawn of them
[[nodiscard]] Result<std::vector<Follower>> readFollowers(const LiveOptions& options, bool drawn, int threads);

/// startRecorder() for a live session.
[[nodiscard]] Result<std::shared_ptr<SessionRecorder>> startRecorder(const LiveOptions& options,
                                                                     const Performer& performer,
                                                                     std::span<const Follower> followers,
                                                                     const World& world);

/// New sources for a session of the followers of a camera, from now on.
[[nodiscard]] Result<std::vector<std::unique_ptr<PoseSource>>> sourcesOf(const LiveOptions& options,
                                                                         const Performer& performer,
                                                                         std::span<const Follower> followers,
                                                                         const WindowTreatment& treatment);

/// @param performer  its streams are taken
/// @param recorder   gets what they give; null = none
[[nodiscard]] Result<Session> startSession(const LiveOptions& options, Performer& performer,
                                           std::span<const Follower> followers,
                                           const std::shared_ptr<SessionRecorder>& recorder, World world);

}  // namespace lorica
