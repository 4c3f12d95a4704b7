#pragma once

#include "acd/decompose.h"
#include "acd/decomposition_file.h"
#include "collision/hulls/cover_choice.h"
#include "collision/hulls/part_hulls.h"
#include "export/rigid_colliders.h"
#include "session/prepare/read_motion.h"
#include "session/prepare/subject.h"

#include <optional>
#include <string>

namespace lorica {

/// What is exported, and how it is divided.
struct ExportSource {
  std::string input;  ///< the mesh or character, with its folder
  Subject subject;
  DecompositionFile content;  ///< of the subject's mesh
};

struct ExportSourceOptions {
  std::string input;          ///< mesh, character, `mannequin`, or a .lorica file next to what it was made from
  std::string decomposition;  ///< .lorica file; empty = decompose
  int parts = 0;              ///< of a mesh; 0 = kExportParts
  double maxConcavity = 0.0;  ///< of a mesh, in concavityUnitOf(); its fewest parts that meet it; 0 = any
  std::optional<DecomposePreset> preset = {};  ///< of a mesh; none = the usual one
  bool divided = true;  ///< false: a character without `decomposition` is not decomposed, and has no parts
  CharacterOptions reading;
};

inline constexpr int kExportParts = 16;

/// Reads and decomposes.
[[nodiscard]] Result<ExportSource> readExportSource(const ExportSourceOptions& options, Host& host);

/// Decomposes a mesh that is no character.
[[nodiscard]] Result<ExportSource> divideMesh(Subject subject, const ExportSourceOptions& options, Host& host);

/// Hulls of a mesh, or of a character's bind pose: they contain every vertex, which is checked.
[[nodiscard]] Result<PartHulls> restHulls(const ExportSource& source, const HullBudget& budget, Host& host);

/// The live hulls of a character in one frame of a motion.
/// @param at  seconds after the motion's first frame
[[nodiscard]] Result<PartHulls> hullsAt(const ExportSource& source, const std::string& motion,
                                        const MotionOptions& reading, double at, const HullBudget& budget, Host& host);

/// Poses of the character's default training, and others to measure.
[[nodiscard]] Result<CoverPoses> exportPoses(const Subject& subject);

}  // namespace lorica
