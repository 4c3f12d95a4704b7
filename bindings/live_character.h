#pragma once

#include "bindings/character_body.h"
#include "collision/live/live_body.h"
#include "collision/live/ray_query.h"
#include "collision/world/self_contact.h"
#include "collision/world/shape_contact.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

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
