#pragma once

#include "acd/decomposition.h"
#include "capture/fault_injector.h"
#include "collision/world/world.h"
#include "session/session_file.h"
#include "session/session_recorder.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

/// Sessions of the mannequin that are quick to make, to record and to run again.
namespace lorica::test {

/// Eight parts of the mannequin from its bind pose.
[[nodiscard]] const Decomposition& eightParts();

/// A recording that ships, from `from` seconds on.
[[nodiscard]] std::vector<SkeletonFrame> shippedFrames(const std::string& name, std::size_t count, double from = 0.0);

/// Of the mannequin among the demo's boxes and balls.
[[nodiscard]] Session demoSession(std::unique_ptr<PoseSource> source);

/// What a session of joints like that is recorded with.
[[nodiscard]] SessionHeader headerOf(const Session& session);

/// Plays joints with faults, throws a ball in step 5 and records all of it.
/// @return the recorder's steps
int recordJoints(const std::filesystem::path& file, std::vector<SkeletonFrame> frames, const FaultSettings& faults = {},
                 const JointSettings& joints = {});

}  // namespace lorica::test
