#pragma once

#include "capture/fault_injector.h"
#include "geometry/result.h"
#include "session/pose_source.h"
#include "session/session.h"
#include "session/session_hashes.h"
#include "session/world_action.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// The inputs of one avatar of a recorded session.
struct AvatarRecord {
  std::string source;            ///< name of the motion: "walk"
  int poseJoints = 0;            ///< joints per recorded pose; 0 = tracked joints were recorded
  bool poseTrust = false;        ///< whether the trust of each joint was recorded with each pose
  bool poseExpressions = false;  ///< whether expressions of the face were recorded with each pose

  std::string character;                 ///< name or file, as given
  std::string boneMap;                   ///< file; empty = none
  double bodyResolution = 0.0;           ///< [m]; 0 = automatic
  std::string walls;                     ///< as given: auto, solid or shell; empty = not given
  double thickness = 0.0;                ///< of thin walls [m]; 0 = automatic
  std::vector<std::string> expressions;  ///< as given, such as "Joy=1": hulls may have grown for them
  std::vector<std::string> hidden;       ///< names of meshes that are left out
  std::optional<std::string> clip;       ///< the character's own clip that it plays, as given; none = another motion
  std::uint64_t characterHash = 0;

  std::string decomposition;             ///< file; empty = the default one
  std::uint64_t decompositionHash = 0;   ///< hashOf(Decomposition)
  std::optional<double> coverTolerance;  ///< requested [m]; 0 = exact
  int hullVertices = 0;                  ///< requested maximum; 0 = no limit
  std::uint64_t coverHash = 0;           ///< 0 = none, exact
  std::uint64_t trainingHash = 0;        ///< 0 = none

  JointSettings joints;
  FaultSettings faults;
  Vec3 place = Vec3::Zero();   ///< of the motion's origin [m]
  double heading = 0.0;        ///< by which the motion is turned around the vertical [degrees]
  std::optional<Vec3f> color;  ///< that tints the look, linear RGB

  std::optional<SpringMode> springs;  ///< none = the avatar had neither springs nor constraints
  std::uint64_t springsHash = 0;      ///< hashOf(SpringBones); 0 = none
};

/// The inputs of a recorded session. File names are those at the time of the recording, as hints for finding the files;
/// hashes verify that the files found are the same.
struct SessionHeader {
  std::vector<AvatarRecord> avatars = std::vector<AvatarRecord>(1);  ///< at least one

  std::string scene;            ///< name or file, as given; empty = the demo scene
  std::string sceneFolder;      ///< base folder of relative mesh paths
  std::uint64_t sceneSeed = 0;  ///< of the demo scene
  std::uint64_t worldHash = 0;  ///< hashOf(World) at the start

  [[nodiscard]] AvatarRecord& avatar(std::size_t index = 0) { return avatars[index]; }
  [[nodiscard]] const AvatarRecord& avatar(std::size_t index = 0) const { return avatars[index]; }
};

/// Size of the largest file that is read, and written [bytes].
inline constexpr std::uint64_t kMaxSessionBytes = std::uint64_t{1} << 30;

/// What the source of one avatar gave in all steps.
struct RecordedMotion {
  std::vector<SkeletonFrame> joints;
  std::vector<double> poseTimes;      ///< [s]
  std::vector<JointTransform> poses;  ///< AvatarRecord::poseJoints for each time
  std::vector<double> poseTrust;      ///< the same number for each time; empty without AvatarRecord::poseTrust
  /// For each time; empty without AvatarRecord::poseExpressions.
  std::vector<std::vector<NamedWeight>> poseExpressions;
};

/// One step of a session: its inputs and results.
struct SessionStep {
  double time = 0.0;        ///< Session::time() after it [s]
  std::size_t frames = 0;   ///< number of joint frames or poses that it consumed, of all avatars
  std::size_t actions = 0;  ///< number of actions applied to the world
  SessionHashes hashes;     ///< Session::hashes() after it
};

/// The contents of a session file.
struct SessionFile {
  SessionHeader header;
  std::string sceneText;                ///< of the scene file; empty = the demo scene
  std::vector<SessionStep> steps;       ///< at least one
  std::vector<RecordedMotion> motions;  ///< of each avatar
  std::vector<WorldAction> actions;     ///< of all steps, concatenated
  bool finished = false;                ///< whether the file was closed; otherwise the program ended before
  std::vector<std::string> notes;       ///< on dropped data
};

/// Where an avatar performs, see SessionAvatar::setPlace(); nothing = where its source says.
/// @param place    of the motion's origin [m]
/// @param heading  by which the motion is turned around the vertical [degrees]
[[nodiscard]] std::optional<Isometry3> placeOf(const Vec3& place, double heading);

/// Reads and validates a .lsession file. An incomplete block at the end is dropped, with a note; all other damage is an
/// error.
/// @return the session, or an error with file, position, found and expected
[[nodiscard]] Result<SessionFile> readSession(const std::filesystem::path& file);
/// The same for bytes in memory. @param name  of the file in error messages
[[nodiscard]] Result<SessionFile> parseSession(std::string_view bytes, const std::string& name);

/// Converts the header to the JSON of its block, and back.
[[nodiscard]] std::string textOf(const SessionHeader& header);
[[nodiscard]] Result<SessionHeader> parseSessionHeader(std::string_view text, const std::string& name);

/// The bytes of .lsession files: a magic word, then blocks, each with kind, length and two checksums that chain it to
/// the previous block. Format: docs/SESSIONS.md.
static_assert(std::endian::native == std::endian::little, "session files are little-endian");

inline constexpr std::string_view kSessionMagic = "LSESSION";
/// Maximum size of a block, to detect invalid lengths [bytes].
inline constexpr std::uint32_t kLargestBlock = 64u << 20u;

enum class BlockKind : std::uint32_t { kHeader = 1, kScene = 2, kStep = 3, kEnd = 4 };

/// Appends a block to a file's bytes. @param chain  checksum of the previous block, input and output; initially 0
void appendBlock(BlockKind kind, std::string_view payload, std::uint64_t& chain, std::string& bytes);

struct Block {
  BlockKind kind = BlockKind::kEnd;
  std::string_view payload;  ///< in the file's bytes
  std::size_t offset = 0;    ///< in the file
};

struct Blocks {
  std::vector<Block> blocks;
  std::size_t cut = 0;  ///< number of bytes of an incomplete block at the end
};

/// Reads all complete blocks of a file. Copies nothing; lengths are checked before they are used.
/// @return the blocks, or an error with the position of damaged bytes
[[nodiscard]] Result<Blocks> readBlocks(std::string_view bytes, const std::string& name);

}  // namespace lorica
