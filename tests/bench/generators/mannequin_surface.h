#pragma once

#include <string>

namespace lorica {

/// The bytes of skinning/mannequin/mannequin.bin, which makeMannequin() reads.
[[nodiscard]] std::string mannequinTable();

}  // namespace lorica
