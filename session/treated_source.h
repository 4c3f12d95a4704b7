#pragma once

#include "capture/fault_injector.h"
#include "capture/skeleton_frame.h"
#include "session/pose_source.h"

#include <memory>
#include <vector>

namespace lorica {

/// What was taken from a source of joints or of poses, as it came, before faults, smoothing and retargeting.
struct SourceLog {
  std::vector<SkeletonFrame> joints;
  std::vector<double> poseTimes;      ///< [s]
  std::vector<JointTransform> poses;  ///< jointCount a time

  void clear() {
    joints.clear();
    poseTimes.clear();
    poses.clear();
  }
};

/// Passes everything on, and keeps it in the log until someone clears it.
[[nodiscard]] std::unique_ptr<SkeletonSource> makeLoggedSource(std::unique_ptr<SkeletonSource> source,
                                                               std::shared_ptr<SourceLog> log);
[[nodiscard]] std::unique_ptr<PoseSource> makeLoggedSource(std::unique_ptr<PoseSource> source,
                                                           std::shared_ptr<SourceLog> log);

/// What becomes of joints or poses between where they come from and a session: first they are logged, then faults are
/// made in them, then joints are smoothed and retargeted. Recording, playing and replaying do the same.
struct SourceTreatment {
  std::shared_ptr<SourceLog> log;  ///< null = nobody keeps them
  FaultSettings faults;
  JointSettings joints;
};

/// @return the source; or which humanoid bones the character lacks
[[nodiscard]] Result<std::unique_ptr<PoseSource>> makeTreatedSource(const Character& character,
                                                                    std::unique_ptr<SkeletonSource> joints,
                                                                    const SourceTreatment& treatment);
/// @param poses  of the character
/// @return the source; or that faults of joints were asked for, see makePoseFaults()
[[nodiscard]] Result<std::unique_ptr<PoseSource>> makeTreatedSource(std::unique_ptr<PoseSource> poses,
                                                                    const SourceTreatment& treatment);

}  // namespace lorica
