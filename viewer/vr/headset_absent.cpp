#include "geometry/errors.h"
#include "viewer/vr/headset.h"

// Without the headers of OpenXR.

namespace lorica {

Result<std::unique_ptr<Headset>> Headset::find() {
  return noDisplay("this Lorica was built without OpenXR: install the Debian package libopenxr-dev and build it again");
}

}  // namespace lorica
