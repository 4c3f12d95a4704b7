#pragma once

#include "capture/sensor/openni.h"
#include "capture/skeleton_frame.h"

#include <filesystem>
#include <memory>
#include <string>

namespace lorica {

/// Skeletons from NiTE 2, for users who have it: closed middleware of PrimeSense that is no longer distributed.
/// Lorica's own tracker does not need it.
///
/// The first tracked person stays selected until NiTE 2 loses them; then the person with the lowest number follows.
/// While nobody is tracked, frames without known joints are returned; while the camera is unplugged, ten per second.
/// The floor comes from NiTE 2; until NiTE 2 knows it, it is assumed 8 cm below the lowest foot seen. As for all
/// sensors, a person who looks at the camera faces +Z.
///
/// @param openNi   provides the camera; NiTE 2 must use the same libOpenNI2
/// @param library  libNiTE2.so, with its data folder NiTE2 beside it
/// @param uri      of a camera; empty: the first one
/// @return a source that waits at most half a second for a camera frame; or an error
[[nodiscard]] Result<std::unique_ptr<SkeletonSource>> makeNiteSource(std::shared_ptr<OpenNi> openNi,
                                                                     const std::filesystem::path& library,
                                                                     const std::string& uri = {});

}  // namespace lorica
