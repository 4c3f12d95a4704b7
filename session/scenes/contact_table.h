#pragma once

#include "session/session.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>

namespace lorica {

/// What the part touches.
enum class ContactKind : std::uint8_t { kFloor, kProp, kSelf, kAvatar };
/// Which foot a bone is of.
enum class ContactFoot : std::uint8_t { kNone, kLeft, kRight };
/// Of a foot: in the air, or on something.
enum class FootPhase : std::uint8_t { kNone, kSwing, kStance };

/// A part of an avatar, and what it touches or nearly touches, in one frame. Plain numbers, for tables.
struct ContactRow {
  double time = 0.0;                  ///< of the frame [s]
  std::int32_t frame = 0;             ///< of the session, from 0
  std::int32_t avatar = 0;            ///< of kAvatar the one with the smaller index
  std::int32_t part = 0;              ///< of that avatar
  std::int32_t bone = kNoJoint;       ///< of the avatar's skeleton, see ContactBones
  std::int32_t otherAvatar = -1;      ///< of kSelf the same avatar; -1 = none
  std::int32_t otherPart = -1;        ///< of kSelf and kAvatar
  std::int32_t otherBone = kNoJoint;  ///< the same, of the other avatar's skeleton
  std::int32_t prop = -1;             ///< of kProp
  float depth = 0.0F;                 ///< if the other moves this far along the normal, they just touch; below 0 the
                                      ///< distance between them [m]
  std::array<float, 3> point{};     ///< middle of overlap or gap, on the floor the lowest point of the part, world [m]
  std::array<float, 3> normal{};    ///< from the part to the other, unit
  std::array<float, 3> velocity{};  ///< of the other as seen from the part, at the point [m/s]
  float strength = 0.0F;            ///< impulse of this frame as in ContactEvents [N s]; 0 if they are apart
  float slip = 0.0F;                ///< share of the velocity's length along the surface [m/s]
  ContactKind kind = ContactKind::kFloor;  ///< what is touched
  ContactFoot foot = ContactFoot::kNone;   ///< whether the bone is of a foot, and of which
  FootPhase phase = FootPhase::kNone;      ///< of that foot in this frame
};

/// Everything that the avatars of a session touch, or are near to, frame by frame: floor, props, their own parts that
/// are no neighbours, and each other. For tables of contact labels, see docs/CONTACTS.md.
///
/// Distances are those of the live hulls, by GJK in double precision (collision/live/hull_distance.h); depths are those
/// of SelfContactQuery, BodyContactQuery and ShapeContactQuery. A prop that was touched within the step counts with
/// that contact's depth if it is deeper. Cylinders are prisms of 32 sides.
///
/// On the floor a part has a row for each foot that it holds, and one for the rest. Velocities are those of bones.
///
/// A foot stands from when it is on the floor, or on a prop below it, by kStandHeight and slower than kStandSpeed,
/// until it is higher than kLeaveHeight or faster than kLeaveSpeed. Its speed is that of the bone over 1/30 s, or a
/// frame if that is longer.
class ContactTable {
 public:
  static constexpr double kNear = 0.05;          ///< usual distance of near pairs [m]
  static constexpr double kStandHeight = 0.045;  ///< [m]
  static constexpr double kLeaveHeight = 0.06;   ///< [m]
  static constexpr double kStandSpeed = 0.4;     ///< [m/s]
  static constexpr double kLeaveSpeed = 0.8;     ///< [m/s]

  /// @param session  whose contacts are wanted; its avatars and their bodies must stay the same
  /// @param near     greatest distance that is reported [m]
  explicit ContactTable(const Session& session, double near = kNear);
  ~ContactTable();
  ContactTable(ContactTable&&) noexcept;
  ContactTable& operator=(ContactTable&&) noexcept;

  /// The rows of the session's last frame, sorted by kind, avatar, part, then the other; call it once after each step.
  /// Allocates nothing once the most rows of a frame have been seen.
  std::span<const ContactRow> update(const Session& session);

  /// Whether the left and the right foot of an avatar stand in the last frame.
  [[nodiscard]] std::array<bool, 2> standing(int avatar) const;
  /// Lowest point of an avatar in all frames so far [m]; infinite before it was there.
  [[nodiscard]] double lowest(int avatar) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lorica
