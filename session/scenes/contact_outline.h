#pragma once

/// Avatars and the props that they meet, as ContactTable sees them. Internal: not installed.

#include "collision/live/extent_kernel.h"
#include "collision/world/shape_contact.h"
#include "session/scenes/contact_table.h"

#include <array>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

namespace lorica {

/// Frames that are closer in time are repeated ones [s].
inline constexpr double kRepeatedFrameSeconds = 0.001;

/// Two things that overlap or are near, as measured.
struct Meeting {
  double depth = 0.0;  ///< below 0 the distance
  Vec3 point = Vec3::Zero(), normal = Vec3::UnitX();
};

/// Two sets of points, with what they are enlarged by, from their convex hulls.
/// @param radius  of the second
/// @return nothing if they are farther from each other than `reach`; a depth of 0 if they meet: a query of overlaps
///         knows how deep
[[nodiscard]] std::optional<Meeting> measured(std::span<const Vec3> first, const Aabb& firstBox,
                                              std::span<const Vec3> second, const Aabb& secondBox, double radius,
                                              double reach);

/// An avatar's hulls in world space, where its bones were, and its feet.
struct ContactOutline {
  explicit ContactOutline(const SessionAvatar& avatar);

  /// Takes a frame. @param since  seconds since the last one
  void read(const SessionAvatar& avatar, double now, double since);
  /// Keeps the frame's bones, for velocities.
  void remember(const SessionAvatar& avatar);

  [[nodiscard]] std::span<const Vec3> pointsOf(std::size_t part) const {
    return std::span(points).subspan(first[part], first[part + 1] - first[part]);
  }
  /// The lowest vertex of a part among those of a foot, or of none; null if there are no such vertices.
  [[nodiscard]] const Vec3* lowestOf(std::size_t part, ContactFoot foot) const;
  /// Velocity of the bone's material at a point since the last frame.
  [[nodiscard]] Vec3 velocityOf(const SessionAvatar& avatar, std::size_t part, JointIndex bone,
                                const Vec3& point) const;
  /// What the bone's mean velocity over at least a frame at 30 Hz has less than velocityOf(). In fast frames a
  /// millimetre of noise is 0.1 m/s at 120 Hz.
  [[nodiscard]] Vec3 noiseOf(const SessionAvatar& avatar, JointIndex bone, const Vec3& point) const;

  ShapeContactQuery query;
  std::vector<double> masses;            ///< of each part
  std::vector<ContactFoot> footOf;       ///< of each joint
  std::vector<ContactFoot> footOfPoint;  ///< of each point of the decomposition

  std::span<const LivePart> parts = {};  ///< none while it is not there
  std::vector<Vec3> points = {};
  std::vector<std::size_t> first = {};  ///< of each part in `points`, and the end
  std::vector<Aabb> boxes = {};
  Aabb box = {};

  std::array<bool, 2> standing{};
  double lowest = kInfinity;

 private:
  /// Where the bones were.
  struct Bones {
    double time = 0.0;
    std::vector<Affine3> worldFromJoint = {};
  };
  double time_ = 0.0, seconds_ = 0.0;  // of the frame
  std::vector<Bones> past_;            // oldest first: one that is kFootSeconds ago or more, and those since
  std::size_t known_ = 0;              // of `past_`; the rest is memory for more
};

/// A prop and a part: measured between hulls, or told by the physics.
struct PropMeeting {
  int avatar = 0, part = 0, prop = 0;
  Meeting meeting;
  double impulse = 0.0;

  [[nodiscard]] auto key() const { return std::tuple(avatar, part, prop); }
};

/// Finds the props that parts of avatars touch or are near to.
class PropMeetings {
 public:
  /// @param reach  to which is searched [m]
  explicit PropMeetings(double reach) : reach_(reach) {}

  /// Those of the session's last frame, in the order of PropMeeting::key(): of each pair the deepest, with all
  /// impulses. Valid until the next call.
  std::span<const PropMeeting> find(const Session& session, std::span<ContactOutline> outlines);

 private:
  /// A convex piece of a prop in world space.
  struct Piece {
    std::vector<Vec3> points = {};
    double radius = 0.0;
    Aabb box;  ///< with the radius
  };
  void setPiece(const Prop& prop, std::size_t hull);
  void findProp(int index, const Prop& prop, int avatar, ContactOutline& outline);

  double reach_;
  std::vector<PropMeeting> found_;
  Piece piece_;
};

}  // namespace lorica
