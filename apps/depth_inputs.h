#pragma once

#include "geometry/result.h"
#include "sensor/depth_source.h"

#include <CLI/CLI.hpp>

#include <memory>
#include <string>

namespace lorica {

/// Which live depth source the command line means.
struct DepthOptions {
  std::string device;  ///< URI; empty = the first
  std::string driver;  ///< file of an OpenNI2 driver to add; empty = none
  bool virtualSensor = false;
  std::string motion = "wave";  ///< what the virtual person performs
};

/// --device, --driver, --virtual, --motion.
void addDepthOptions(CLI::App& app, DepthOptions& options);

/// Opens the depth source, live.
/// @return the source; or why there is none and what helps
[[nodiscard]] Result<std::unique_ptr<DepthSource>> openDepth(const DepthOptions& options);

}  // namespace lorica
