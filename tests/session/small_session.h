#pragma once

#include "acd/decomposition.h"
#include "capture/fault_injector.h"
#include "collision/world/world.h"
#include "session/recording/session_file.h"
#include "session/recording/session_recorder.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

/// Sessions of the mannequin that are quick to make, to record and to replay.
namespace lorica::test {

/// Eight parts of the mannequin from its bind pose.
[[nodiscard]] const Decomposition& eightParts();

/// A shipped recording, starting at `from` seconds.
[[nodiscard]] std::vector<SkeletonFrame> shippedFrames(const std::string& name, std::size_t count, double from = 0.0);

/// A session of the mannequin in the demo scene.
[[nodiscard]] Session demoSession(std::unique_ptr<PoseSource> source);

/// The header for recording such a session from joints.
[[nodiscard]] SessionHeader headerOf(const Session& session);

/// Plays joints with faults, throws a ball in step 5 and records the session.
/// @return number of recorded steps
int recordJoints(const std::filesystem::path& file, std::vector<SkeletonFrame> frames, const FaultSettings& faults = {},
                 const JointSettings& joints = {});

}  // namespace lorica::test
