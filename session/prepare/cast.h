#pragma once

#include "acd/decomposition_file.h"
#include "session/prepare/body.h"
#include "session/prepare/read_motion.h"
#include "session/prepare/subject.h"
#include "session/recording/session_recorder.h"
#include "session/scenes/hit_counter.h"
#include "session/scenes/scene_file.h"
#include "session/session.h"
#include "session/session_springs.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

struct PreparedAvatar;

/// What is asked of a run: motions and characters, one for each avatar, and the world around them.
struct CastRequest {
  std::string motion;     ///< several, separated by commas: an avatar each; empty = the character's own clip
  std::string character;  ///< one for all avatars or one for each; empty = the mannequin, or the motion's file if it is
                          ///< a character with a surface
  CharacterOptions reading;
  MotionOptions performing;
  std::string springs;  ///< see chooseSprings()
  BodyOptions body;
  std::string scene;                ///< see readSceneText()
  std::vector<std::string> meshes;  ///< files that become props
  /// Asked about the avatars before their bodies are decomposed, which takes longest; null = all are accepted.
  std::function<Result<void>(std::span<const PreparedAvatar>)> check = nullptr;
  /// Whether the hulls of the bodies are looked at. If not, prepareCast() makes none, see wholeBody(), unless they
  /// touch something that is asked for: a scene, props, hair that rests on the body; or the request chooses them.
  bool hulls = true;

  /// The files that it names, which no output may overwrite.
  [[nodiscard]] std::vector<std::filesystem::path> files() const;
};

/// The springs and constraints of a character and what they do.
struct SpringChoice {
  SpringBones springs;
  SpringMode mode = SpringMode::kFile;
};

/// @param mode  as given; empty = usualSpringMode()
/// @return none if there is nothing to move: neither springs, or the mode is none, nor constraints
[[nodiscard]] std::optional<SpringChoice> chooseSprings(const Subject& subject, const std::string& mode);

/// An avatar that was read and decomposed, ready for a session.
struct PreparedAvatar {
  AvatarSetting setting;                    ///< as asked for
  std::string source;                       ///< name of what moves it: "walk"
  bool poses = false;                       ///< poses of bones move it; else joints
  bool stream = false;                      ///< the poses come with trust and expressions, see PoseSource
  Subject subject;                          ///< with a character
  std::optional<Motion> motion = {};        ///< none = a camera, a program that sends, or a recorded session
  std::optional<std::string> ownClip = {};  ///< the character's own clip that it performs, as given; see findClip()
  DecompositionFile body = {};
  std::optional<SpringChoice> springs = {};

  [[nodiscard]] const Character& character() const { return *subject.character; }
};

/// What moves the avatars of a cast.
class CastSources {
 public:
  virtual ~CastSources() = default;
  /// A new source for an avatar: of recordings from their start, of what is live from now on.
  /// @param performing  mirror, smoothing and faults
  /// @param log         gets what the source gives; null = none
  [[nodiscard]] virtual Result<std::unique_ptr<PoseSource>> open(const PreparedAvatar& avatar, std::size_t index,
                                                                 const MotionOptions& performing,
                                                                 std::shared_ptr<SourceLog> log) = 0;
};

/// What else the file of a cast's motion holds: other clips of a character file, other people of a recording.
struct CastChoices {
  std::vector<std::string> clips;   ///< empty = there is at most one
  int clip = 0;                     ///< index of the played one
  std::vector<std::string> people;  ///< their numbers; empty = there is at most one
  int person = 0;                   ///< index of the followed one; -1 = everyone
  bool everyone = false;            ///< everyone may be followed at once
};

/// The avatars of a run, prepared, and their world.
struct Cast {
  CastRequest request;  ///< `hulls`: whether they were made
  World world;
  std::vector<HitTarget> targets = {};  ///< of the scene
  std::vector<PreparedAvatar> avatars = {};
  std::shared_ptr<CastSources> sources = {};
  std::string name = {};         ///< "walk and wave"
  double seconds = 0.0;          ///< of the longest motion; 0 = live
  std::vector<Prop> added = {};  ///< of the request's meshes, which are in `world` already
  double propScale = 1.0;        ///< of the boxes and balls of the demo
  CastChoices choices = {};
};

/// The parts of a text between commas; a file whose name has commas is one.
[[nodiscard]] std::vector<std::string> namesIn(const std::string& text);

/// An avatar whose body is not decomposed yet. @param given  its motion; none = the one that the setting names
[[nodiscard]] Result<PreparedAvatar> readAvatar(const CastRequest& request, const AvatarSetting& setting,
                                                std::optional<Motion> given, Host& host);

/// Reads the avatars that the request names, one for each motion ("walk,wave"), next to each other, 1.2 m apart, all
/// with one character or each with its own; else those of the scene. Opens the scene and decomposes the bodies. In the
/// place of the motion may be a scene, too, or a mesh that becomes a prop.
[[nodiscard]] Result<Cast> prepareCast(const CastRequest& request, Host& host);

/// prepareCast(), and sand and water settle as in the first step of the session.
/// @param attempts  the first that can be prepared is; if none can, the error of the first counts
[[nodiscard]] Result<Cast> prepareSettledCast(const std::vector<CastRequest>& attempts, Host& host);

/// The sources of a cast whose avatars have motions.
[[nodiscard]] std::shared_ptr<CastSources> motionSources();

/// What the user can choose in the motion's file.
[[nodiscard]] CastChoices choicesOf(const CastRequest& request, std::span<const PreparedAvatar> avatars);

/// Adds an avatar to a session.
[[nodiscard]] Result<void> addAvatar(Session& session, const PreparedAvatar& avatar,
                                     std::unique_ptr<PoseSource> source);

/// New sources for all avatars.
/// @param recorder  its logs get what the sources give; null = none
[[nodiscard]] Result<std::vector<std::unique_ptr<PoseSource>>> openSources(const Cast& cast,
                                                                           const MotionOptions& performing,
                                                                           const SessionRecorder* recorder = nullptr);

/// A session of the cast, whose world is taken.
[[nodiscard]] Result<Session> startSession(Cast& cast, const SessionRecorder* recorder = nullptr);

/// Starts to record a session of the cast. @param file  NAME.lsession; empty = none
/// @return the recorder, which must watch the session and whose logs the sources need; null if none was asked for
[[nodiscard]] Result<std::shared_ptr<SessionRecorder>> startRecorder(const std::string& file, const Cast& cast,
                                                                     Host& host);

/// Says that a file was found that a killed program left behind. @param found  its new name; none = nothing is said
void warnOfFound(const std::optional<std::filesystem::path>& found, Host& host);

/// Adds props to a world, as they are.
void addProps(std::span<const Prop> props, World& world);

}  // namespace lorica
