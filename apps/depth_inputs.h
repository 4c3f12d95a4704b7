#pragma once

#include "apps/command_line.h"
#include "capture/sensor/depth_source.h"
#include "capture/skeleton_frame.h"
#include "geometry/result.h"

#include <memory>
#include <string>

namespace lorica {

/// Which live depth source the command line means.
struct DepthOptions {
  std::string device;          ///< URI; empty = the first
  std::string driver;          ///< file of an OpenNI2 driver to add; empty = none
  bool virtualCamera = false;  ///< Lorica's own driver, see docs/VIRTUAL_SENSOR.md
  std::string motion;          ///< what virtual people perform; empty = as $LORICA_VIRTUAL says
};

/// --device, --driver, --virtual, --motion.
void addDepthOptions(CommandLine& app, DepthOptions& options);

/// Opens a camera through OpenNI2, be it a virtual one.
/// @return the source; or why there is none and what helps
[[nodiscard]] Result<std::unique_ptr<DepthSource>> openCamera(const DepthOptions& options);

/// The skeletons that NiTE 2 makes of such a camera, see makeNiteSource().
/// @param library  libNiTE2.so
[[nodiscard]] Result<std::unique_ptr<SkeletonSource>> openNite(const DepthOptions& options, const std::string& library);

/// As openCamera(), but a virtual camera needs no OpenNI2.
[[nodiscard]] Result<std::unique_ptr<DepthSource>> openDepth(const DepthOptions& options);

}  // namespace lorica
