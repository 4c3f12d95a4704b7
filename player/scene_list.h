#pragma once

#include <string>
#include <vector>

namespace lorica {

/// The scenes that a window offers.
struct SceneList {
  std::vector<std::string> names;
  std::vector<std::string> arguments;  ///< of openScene()
  int present = 0;                     ///< index of the current one
};

/// The scene of the demo, the shipped ones, and the present one if it is the user's own.
/// @param present  as given to openScene()
[[nodiscard]] SceneList scenesNextTo(const std::string& present);

}  // namespace lorica
