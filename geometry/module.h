#pragma once

#include "geometry/result.h"

#include <string_view>

namespace lorica {

/// Loads one of Lorica's own shared libraries when it is first needed: what it links takes long to load, or need not be
/// installed. It stays loaded. The run path of the program says where it lies; `lorica_module` in
/// cmake/LoricaTargets.cmake sees to that.
/// @param name     of the library, as given to lorica_module()
/// @param symbol   a constant in it, of a type that caller and library agree on
/// @param purpose  what fails without it, to begin the sentence with: "writing MP4"
/// @return its address, or what the loader found missing
[[nodiscard]] Result<const void*> loadModule(std::string_view name, const char* symbol, std::string_view purpose);

}  // namespace lorica
