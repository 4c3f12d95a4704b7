#pragma once

#include "capture/retarget.h"
#include "capture/skeleton_frame.h"
#include "collision/live_body.h"
#include "collision/world.h"
#include "skinning/character.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace lorica {

/// Time of each stage of one frame [us]; retarget includes forward kinematics.
struct StageTimes {
  double retarget = 0, motion = 0, points = 0, hulls = 0, physics = 0;
  [[nodiscard]] double total() const { return retarget + motion + points + hulls + physics; }
};

/// The headless frame: source -> pose -> hulls -> contacts. Tests, benchmarks, pictures and the window run this.
class Session {
 public:
  /// @return the session, or which humanoid bones the character lacks, or that the decomposition fits another mesh
  static Result<Session> create(Character character, Decomposition decomposition,
                                std::unique_ptr<SkeletonSource> source, World world);

  /// Runs one frame. Physics moves by the time between frames, held between 1 ms and 0.1 s; the first takes 1/30 s.
  /// @return false at the end of the stream, or what the source says is wrong with its data
  [[nodiscard]] Result<bool> step();

  [[nodiscard]] const Character& character() const { return character_; }
  [[nodiscard]] const SkeletonFrame& frame() const { return frame_; }
  [[nodiscard]] std::span<const Affine3> worldFromJoint() const { return worldFromJoint_; }
  /// The posed mesh and the cut points, pointCount() of them [m]. Physics needs neither: they are computed for
  /// pictures, when asked for.
  [[nodiscard]] std::span<const Vec3> points() const;
  [[nodiscard]] const LiveBody& body() const { return body_; }
  [[nodiscard]] const World& world() const { return world_; }
  [[nodiscard]] World& world() { return world_; }
  [[nodiscard]] const StageTimes& times() const { return times_; }
  [[nodiscard]] int frameCount() const { return frameCount_; }
  /// XXH3 over the shapes and places of all parts in all frames so far, bit for bit.
  [[nodiscard]] std::uint64_t hash() const { return hash_; }

 private:
  Session(Character character, Decomposition decomposition, std::unique_ptr<SkeletonSource> source, World world,
          Retargeter retargeter);
  Character character_;
  std::unique_ptr<SkeletonSource> source_;
  Retargeter retargeter_;
  LiveBody body_;
  World world_;
  SkeletonFrame frame_;
  Pose pose_;
  std::vector<Affine3> worldFromJoint_, worldFromModel_;
  mutable std::vector<Vec3> points_;  // of the frame pointsFrame_
  mutable int pointsFrame_ = -1;
  StageTimes times_;
  int frameCount_ = 0;
  std::uint64_t hash_ = 0;
};

}  // namespace lorica
