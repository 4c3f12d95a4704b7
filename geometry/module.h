#pragma once

#include "geometry/result.h"

#include <string>
#include <string_view>

namespace lorica {

/// Loads one of Lorica's shared libraries on first use, because its dependencies load slowly or may not be installed.
/// The library stays loaded. It is found by the program's run path, which `lorica_module` in
/// tools/cmake/LoricaTargets.cmake sets.
/// @param name     of the library, as given to lorica_module()
/// @param symbol   a constant in the library, of a type that caller and library agree on
/// @param purpose  the feature that needs the library, as the start of the error message: "writing MP4"
/// @return the address of the symbol, or the loader's error
[[nodiscard]] Result<const void*> loadModule(std::string_view name, const char* symbol, std::string_view purpose);

/// The Debian package of a library that the loader misses: of "libopencv_videoio.so.406: cannot open shared object
/// file: ..." it is libopencv-videoio406. @return empty if the loader's problem is another one
[[nodiscard]] std::string packageOf(std::string_view problem);

}  // namespace lorica
