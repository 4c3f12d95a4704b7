#pragma once

#include <string>

namespace lorica {

/// An expression that a source of motion shows, by the source's own name: "Joy", "happy".
struct NamedWeight {
  std::string name;     ///< of the expression
  float weight = 0.0f;  ///< 0 to 1

  [[nodiscard]] bool operator==(const NamedWeight&) const = default;
};

}  // namespace lorica
