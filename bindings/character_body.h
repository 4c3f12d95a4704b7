#pragma once

#include "acd/decomposition_file.h"
#include "bindings/program_host.h"
#include "collision/live/body_plan.h"
#include "collision/live/live_body.h"
#include "collision/live/ray_query.h"
#include "collision/world/self_contact.h"
#include "collision/world/shape_contact.h"
#include "session/prepare/cover_choice.h"
#include "session/prepare/subject.h"
#include "skinning/clip.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// A subject with a character.
using CharacterPointer = std::shared_ptr<const Subject>;

/// @param nameOrFile  "mannequin", or a .glb, .gltf, .vrm, .fbx or .dae file with a skin or clips
[[nodiscard]] Result<CharacterPointer> openCharacter(const std::string& nameOrFile, const CharacterOptions& reading,
                                                     Host& host);

/// What was repaired, guessed or left out when its file was read: one sentence each.
[[nodiscard]] std::vector<std::string> notesOf(const Subject& character);

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

/// Decomposes a character, trained on its own clips and on the shipped recordings: as `lorica decompose` does with a
/// number of parts, else as `lorica play` does.
[[nodiscard]] Result<std::shared_ptr<const CharacterBody>> makeCharacterBody(CharacterPointer owner,
                                                                             const CharacterBodySettings& settings,
                                                                             Host& host);

/// The body in a .lorica file that was made from this character.
[[nodiscard]] Result<std::shared_ptr<const CharacterBody>> readCharacterBody(CharacterPointer owner,
                                                                             const std::filesystem::path& file);

struct Performance {
  SkeletalMotion motion;
  std::string firstGuess;  ///< what its file was taken to be; empty for one that has nothing to guess
};

/// A motion as the character performs it: of any file that `lorica play` knows, or a shipped recording by its name,
/// such as "walk", which is made again.
/// @param clip  of a character file with several; empty = the first
[[nodiscard]] Result<Performance> performanceOf(const Character& character, const std::string& nameOrFile,
                                                const std::string& clip, bool mirror, Host& host);

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
  /// Whether it was ever moved. Before that the hulls are empty.
  [[nodiscard]] bool posed() const { return posed_; }
  /// In world space [m], one for each part.
  [[nodiscard]] std::span<const ConvexHull> hulls() const { return hulls_; }
  /// See sweptPoints(): first those of hulls(). The first call of all reserves memory. Only after the first pose.
  [[nodiscard]] std::span<const Vec3> swept(PartIndex part);
  /// See LiveBody::support(). Only after the first pose.
  [[nodiscard]] Vec3 support(PartIndex part, const Vec3& direction) const { return live_.support(part, direction); }
  /// See SelfContactQuery. The first call prepares the query.
  [[nodiscard]] std::span<const SelfContact> selfContacts();
  /// See ShapeContactQuery. The first call prepares the query. @param shape  that checkShape() accepts
  [[nodiscard]] std::span<const ShapeContact> touches(const RoundedShape& shape);
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
  std::optional<SelfContactQuery> contacts_;
  std::optional<ShapeContactQuery> touches_;
  std::vector<std::vector<Vec3>> swept_;  ///< of each part; empty until asked for in a pose
  RayQuery rays_;
  std::optional<PosedSkin> skin_;
  bool raysKnowPose_ = false, skinKnowsPose_ = false;
  bool posed_ = false;
};

/// An error if a time between poses is not above 0.
[[nodiscard]] Result<void> checkSeconds(double seconds);

/// An error if a length is below 0 or not a number. @param reach  of rays [m]
[[nodiscard]] Result<void> checkCast(double reach, double radius, const Vec3& half);

/// An error if a shape has no points, or a number that is not finite, below 0, or beyond 1,000 km.
[[nodiscard]] Result<void> checkShape(const RoundedShape& shape);

}  // namespace lorica
