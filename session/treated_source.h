#pragma once

#include "capture/fault_injector.h"
#include "capture/skeleton_frame.h"
#include "session/pose_source.h"

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace lorica {

/// Appends numbers to a byte string.
class ByteWriter {
 public:
  template <typename Number>
  /// Appends a number as it is in memory.
  void put(Number number) {
    static_assert(std::is_arithmetic_v<Number>);
    const auto* bytes = reinterpret_cast<const char*>(&number);
    bytes_.append(bytes, sizeof(Number));
  }
  void put(std::string_view bytes) { bytes_ += bytes; }            ///< appends them
  void clear() { bytes_.clear(); }                                 ///< keeps the memory
  [[nodiscard]] std::string_view bytes() const { return bytes_; }  ///< all that was appended

 private:
  std::string bytes_;
};

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

/// Injects faults of whole frames into poses: late and freeze, see FaultSettings. Allocates nothing per frame.
/// @return the source, or an error if the settings have faults of single joints, which do not apply to poses
[[nodiscard]] Result<std::unique_ptr<PoseSource>> makePoseFaults(std::unique_ptr<PoseSource> source,
                                                                 const FaultSettings& settings);

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
