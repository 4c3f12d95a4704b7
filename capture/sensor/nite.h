#pragma once

#include "capture/sensor/openni.h"
#include "capture/skeleton_frame.h"

#include <filesystem>
#include <memory>
#include <string>

namespace lorica {

/// Skeletons of NiTE 2, for who has it: closed middleware of PrimeSense that nobody gives out any more. Lorica's own
/// tracker needs nothing of it.
///
/// The first person stays the one until NiTE 2 loses them; then the one with the lowest number follows. While nobody is
/// tracked, frames with no known joint come; and while the camera is unplugged, ten a second, until it is back. The
/// floor is NiTE 2's, and until it knows one 8 cm below the lowest foot seen. As with all sensors' joints, who looks at
/// the camera faces +Z.
///
/// @param openNi   which gives the camera; NiTE 2 must use the same libOpenNI2
/// @param library  libNiTE2.so, with its folder NiTE2 of data beside it
/// @param uri      of a camera; empty: the first
/// @return a source that waits for the camera's frames, half a second at most; or why not
[[nodiscard]] Result<std::unique_ptr<SkeletonSource>> makeNiteSource(std::shared_ptr<OpenNi> openNi,
                                                                     const std::filesystem::path& library,
                                                                     const std::string& uri = {});

}  // namespace lorica
