#include "capture/sensor/openni.h"
#include "geometry/errors.h"

// Compiled if OpenNI2's headers are not available.

namespace lorica {

Result<std::shared_ptr<OpenNi>> OpenNi::start(const OpenNiSettings&) {
  return unsupported(
      "this Lorica was built without OpenNI2, so it supports no depth cameras: build it with libopenni2-dev");
}

Result<std::unique_ptr<SkeletonSource>> makeNiteSource(std::shared_ptr<OpenNi>, const std::filesystem::path&,
                                                       const std::string&) {
  return unsupported("this Lorica was built without OpenNI2, which NiTE 2 needs: build it with libopenni2-dev");
}

}  // namespace lorica
