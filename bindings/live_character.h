#pragma once

#include "acd/decomposition_file.h"
#include "bindings/program_host.h"
#include "collision/hulls/cover_choice.h"
#include "collision/hulls/subject.h"
#include "collision/live/body_plan.h"
#include "collision/live/live_body.h"
#include "collision/live/posed_skin.h"
#include "collision/live/ray_query.h"
#include "skinning/skeleton.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// A subject with a character.
using CharacterPointer = std::shared_ptr<const Subject>;

/// What was repaired, guessed or left out when its file was read: one sentence each.
[[nodiscard]] std::vector<std::string> notesOf(const Subject& character);

/// A matrix by columns; none if a number is not finite or the last row is not 0 0 0 1, see kBadMatrix.
[[nodiscard]] std::optional<Affine3> affineFrom(const double* numbers);
/// Follows the name of such a matrix in an error.
inline constexpr const char* kBadMatrix =
    "has a number that is not finite, or a last row that is not 0 0 0 1; matrices are stored by columns";

/// A skinned mesh that a program has read itself.
struct GivenSkin {
  std::string name = "character";
  std::span<const double> positions;      ///< x y z of each vertex in the bind pose, model space [m]
  std::span<const std::int32_t> corners;  ///< three of each triangle
  std::span<const std::int32_t> joints;   ///< `perVertex` of each vertex
  std::span<const double> weights;        ///< the same; those that are 0 have no effect, each vertex needs one above
  std::size_t perVertex = 4;
  std::span<const double> jointFromModel;  ///< inverse bind matrices: 16 numbers of each joint, by columns
};

/// An error if a length of the options is below 0 or not finite.
[[nodiscard]] Result<void> checkLengths(const CharacterOptions& options);

/// The skin as a character, whose joints have no parents: in the options, `body`, `bodyResolution`, `walls` and
/// `thickness` count, as for the character of a file.
[[nodiscard]] Result<CharacterPointer> makeCharacter(const GivenSkin& skin, const CharacterOptions& options,
                                                     Host& host);

/// A decomposed character, ready to be moved. Immutable.
struct CharacterBody {
  CharacterPointer owner;
  DecompositionFile content;
  std::shared_ptr<const BodyPlan> plan;
  std::string warning;  ///< see doubtAboutHulls()

  [[nodiscard]] const Character& character() const { return *owner->character; }
};

struct CharacterBodySettings {
  int parts = 0;       ///< at most; 0 = the body of `lorica play`, 16 parts, kept in the user's cache
  CoverRequest cover;  ///< not given = exact
};

/// Checks a request, decomposes a character in the most different of some poses, and makes its body.
/// @param worldFromJoint  poses x jointCount, at least one pose [m]
[[nodiscard]] Result<std::shared_ptr<const CharacterBody>> makeBodyInPoses(CharacterPointer owner,
                                                                           std::span<const Affine3> worldFromJoint,
                                                                           const CharacterBodySettings& settings,
                                                                           Host& host);

/// The body of a character with these parts.
[[nodiscard]] Result<std::shared_ptr<const CharacterBody>> bodyOf(CharacterPointer owner, DecompositionFile content);

/// The body in a .lorica file that was made from this character.
[[nodiscard]] Result<std::shared_ptr<const CharacterBody>> readCharacterBody(CharacterPointer owner,
                                                                             const std::filesystem::path& file);

/// The same of the bytes of such a file.
[[nodiscard]] Result<std::shared_ptr<const CharacterBody>> parseCharacterBody(CharacterPointer owner,
                                                                              std::string_view bytes);

/// A body that is moved from pose to pose, and its hulls in world space. After the first frames nothing allocates.
class LiveCharacter {
 public:
  explicit LiveCharacter(std::shared_ptr<const CharacterBody> body);

  /// @param pose  jointCount local transforms
  void pose(std::span<const JointTransform> pose);
  /// @param worldFromJoint  jointCount transforms
  void place(std::span<const Affine3> worldFromJoint);

  [[nodiscard]] const CharacterBody& body() const { return *body_; }
  [[nodiscard]] std::span<const Affine3> worldFromJoint() const { return worldFromJoint_; }
  [[nodiscard]] std::span<const LivePart> parts() const { return live_.parts(); }
  /// Of all parts.
  [[nodiscard]] const LiveBody& liveBody() const { return live_; }
  /// How often it was moved. Before the first time the hulls are empty.
  [[nodiscard]] std::uint64_t poses() const { return poses_; }
  /// Whether it was ever moved.
  [[nodiscard]] bool posed() const { return poses_ > 0; }
  /// In world space [m], one for each part.
  [[nodiscard]] std::span<const ConvexHull> hulls() const { return hulls_; }
  /// See sweptPoints(): first those of hulls(). The first call of all reserves memory. Only after the first pose.
  [[nodiscard]] std::span<const Vec3> swept(PartIndex part);
  /// See LiveBody::support(). Only after the first pose.
  [[nodiscard]] Vec3 support(PartIndex part, const Vec3& direction) const { return live_.support(part, direction); }
  /// Answers rays against the present pose; before the first one they hit nothing.
  [[nodiscard]] const RayQuery& rays();
  /// The nearest point of the closed body's skin, see RayQuery. The first call prepares the query.
  [[nodiscard]] SkinHit castOnSkin(const HullRay& ray);

 private:
  void move();

  std::shared_ptr<const CharacterBody> body_;
  LiveBody live_;
  std::vector<Affine3> worldFromJoint_, worldFromModel_;
  std::vector<ConvexHull> hulls_;
  std::vector<std::vector<Vec3>> swept_;  ///< of each part; empty until asked for in a pose
  RayQuery rays_;
  std::optional<PosedSkin> skin_;
  bool raysKnowPose_ = false, skinKnowsPose_ = false;
  std::uint64_t poses_ = 0;
};

/// An error if a time between poses is not above 0.
[[nodiscard]] Result<void> checkSeconds(double seconds);

/// An error if a length is below 0 or not a number. @param reach  of rays [m]
[[nodiscard]] Result<void> checkCast(double reach, double radius, const Vec3& half);

}  // namespace lorica
