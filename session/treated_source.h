#pragma once

#include "capture/fault_injector.h"
#include "capture/skeleton_frame.h"
#include "session/byte_writer.h"
#include "session/pose_source.h"

#include <memory>
#include <span>
#include <vector>

namespace lorica {

/// Raw joints or poses that were read from a source, before faults, smoothing and retargeting.
struct SourceLog {
  std::vector<SkeletonFrame> joints;  ///< in their order, before smoothing and faults
  std::vector<double> poseTimes;      ///< [s]
  std::vector<JointTransform> poses;  ///< jointCount per time
  std::vector<double> trust;          ///< jointCount per time; empty if the source has none, see PoseSource::trust()
  ByteWriter expressions;             ///< of each time, as session files hold them, see putExpressions()

  /// Keeps the memory
  void clear() {
    joints.clear();
    poseTimes.clear();
    poses.clear();
    trust.clear();
    expressions.clear();
  }
};

/// Appends the expressions of one pose: their number in two bytes; for each the length of its name in one byte, the
/// name, and the weight. Those beyond the budgets are left out.
void putExpressions(std::span<const NamedWeight> expressions, ByteWriter& bytes);

/// Passes everything through and appends it to the log; the caller clears the log.
[[nodiscard]] std::unique_ptr<SkeletonSource> makeLoggedSource(std::unique_ptr<SkeletonSource> source,
                                                               std::shared_ptr<SourceLog> log);
/// A source that appends the poses that it gives to a log.
[[nodiscard]] std::unique_ptr<PoseSource> makeLoggedSource(std::unique_ptr<PoseSource> source,
                                                           std::shared_ptr<SourceLog> log);

/// Processing of joints or poses between their source and a session: they are logged, then faults are injected, then
/// joints are smoothed and retargeted. The same for recording, playback and replay.
struct SourceTreatment {
  std::shared_ptr<SourceLog> log;  ///< null = no log
  FaultSettings faults;            ///< what is made worse on purpose
  JointSettings joints;            ///< how joints are treated before they become a pose
};

/// @return the source, or an error with the humanoid bones that the character lacks, or that faults are out of range
[[nodiscard]] Result<std::unique_ptr<PoseSource>> makeTreatedSource(const Character& character,
                                                                    std::unique_ptr<SkeletonSource> joints,
                                                                    const SourceTreatment& treatment);
/// @param poses  of the character
/// @return the source, or an error if the settings have faults of joints or out of range, see makePoseFaults()
[[nodiscard]] Result<std::unique_ptr<PoseSource>> makeTreatedSource(std::unique_ptr<PoseSource> poses,
                                                                    const SourceTreatment& treatment);

}  // namespace lorica
