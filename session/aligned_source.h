#pragma once

#include "geometry/math.h"
#include "session/pose_source.h"
#include "skinning/skeleton.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace lorica {

/// A source of poses in the time of a session with several avatars, whose sources may have other frame rates and start
/// at other times.
///
/// One source leads: its frames are the frames of the session. The others follow: they show their pose at that time,
/// between two of their frames interpolated (rotations spherically, the rest linearly). A source begins when its avatar
/// joins the session; at its end the last pose stays.
class AlignedSource {
 public:
  /// @param skeleton  of the poses
  AlignedSource(std::unique_ptr<PoseSource> source, const Skeleton& skeleton);

  /// Moves and turns the poses of all later frames. @param worldFromSource  rigid
  void setPlace(const Isometry3& worldFromSource) { worldFromSource_ = worldFromSource; }

  /// Makes the first frame that of a time, instead of the source's own. Call it before the first frame.
  /// @param time  of the session [s]
  void joinAt(double time) { joined_ = time; }

  /// Leads: goes to the next frame.
  /// @return its time in the session [s]; nothing at the end; an error of the source
  [[nodiscard]] Result<std::optional<double>> lead();
  /// Follows: goes to a time, which must not fall.
  /// @param time  of the session [s]
  [[nodiscard]] Result<void> follow(double time);

  /// Whether there are no more frames.
  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] std::span<const JointTransform> pose() const { return pose_; }  ///< jointCount of the character
  [[nodiscard]] const PoseSource& source() const { return *source_; }           ///< the one that it was made of
  /// Whether the avatar is there, see PoseSource::present(): from the first frame on.
  [[nodiscard]] bool present() const { return started_ && source_->present(); }

 private:
  [[nodiscard]] Result<void> read();
  void place();

  std::unique_ptr<PoseSource> source_;
  std::vector<JointIndex> roots_;               ///< joints without a parent
  std::optional<Isometry3> worldFromSource_;    ///< none = identity
  Pose pose_;                                   ///< that is shown
  Pose previous_, next_;                        ///< the last two frames that were read
  double previousTime_ = 0.0, nextTime_ = 0.0;  ///< in the session's time [s]
  std::optional<double> joined_;                ///< time of the first frame in the session [s]
  double sessionFromSource_ = 0.0;              ///< [s]
  bool started_ = false, ended_ = false;
  bool pending_ = false;  ///< whether next_ was read, but lies ahead of what is shown
};

}  // namespace lorica
