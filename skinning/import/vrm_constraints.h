#pragma once

#include "skinning/import/gltf_document.h"
#include "skinning/import/vrm_values.h"

#include <vector>

namespace lorica {

/// Reads VRMC_node_constraint 1.0; faulty ones are skipped.
void readVrmConstraints(const GltfDocument& document, VrmValues& values, std::vector<NodeConstraint>& constraints);

}  // namespace lorica
