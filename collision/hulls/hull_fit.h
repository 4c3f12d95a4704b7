#pragma once

#include "acd/decompose.h"
#include "acd/decomposition_file.h"
#include "collision/hulls/cover_choice.h"
#include "collision/hulls/part_hulls.h"
#include "collision/hulls/quality.h"
#include "collision/hulls/subject.h"
#include "collision/hulls/training.h"

#include <optional>

namespace lorica {

/// What parts are made for.
struct FitRequest {
  const Subject& subject;
  const Keyframes& keyframes;
  const CoverPoses* coverPoses = nullptr;  ///< of a character whose cover is not exact; else null
  CoverRequest cover;                      ///< of a mesh, only the budget of hulls is used
  bool exported = false;                   ///< whether a character's hulls are exported in the bind pose
  /// Its limits are to hold on the hulls that are used: those that are exported for a mesh, the live ones in the
  /// keyframes for a character.
  DecomposeSettings settings;

  [[nodiscard]] bool limited() const {
    return settings.maxError > 0.0 || settings.maxDistance > 0.0 || settings.maxConcavity > 0.0;
  }
};

/// Parts and the hulls that are used for them. All figures are those of these hulls.
struct Fit {
  TimedDecomposition made;
  std::size_t attached = 0;        ///< vertices that no part contains but its hull does
  Decomposition held;              ///< the parts with those vertices
  PartHulls exported;              ///< of a mesh; of a character's bind pose if they are exported
  std::optional<HullCover> cover;  ///< of a character, unless it is exact
  UsedHulls hulls;                 ///< in each keyframe
  Quality quality;
  std::optional<double> distance;      ///< see measureDistance(), if it is limited
  std::optional<Concavity> concavity;  ///< see measureConcavity(), if it is limited
  bool stalled = false;                ///< a limit is missed, and more parts do not help

  [[nodiscard]] bool errorMet(const DecomposeSettings& settings) const;
  [[nodiscard]] bool distanceMet(const DecomposeSettings& settings) const;
  [[nodiscard]] bool concavityMet(const DecomposeSettings& settings) const;
  [[nodiscard]] bool met(const DecomposeSettings& settings) const {
    return errorMet(settings) && distanceMet(settings) && concavityMet(settings);
  }
  /// The largest of error, distance and concavity, as multiples of their limits.
  [[nodiscard]] double excess(const DecomposeSettings& settings) const;
};

/// Decomposes until the limits hold on the hulls that are used, with few parts. Those hulls can be larger than those of
/// the parts: by few vertices, or by vertices that no part contains. Then the number of parts is found by trying some.
/// The numbers of parts and of vertices are always kept. Where the other limits cannot be met, the parts that came
/// nearest to them are returned.
[[nodiscard]] Result<Fit> fitHulls(const FitRequest& request, Host& host);

/// The hulls that are used of parts that were made before, and their figures.
/// @param made  of the subject's mesh, or of another one with the same triangles
[[nodiscard]] Result<Fit> fitOf(const FitRequest& request, TimedDecomposition made, Host& host);

/// The content of a .lorica file. Of a mesh it has all points, whatever the budget of the exported hulls.
/// @param training  of a character; else null
[[nodiscard]] DecompositionFile fileContent(const FitRequest& request, const Training* training, const Fit& fit);

}  // namespace lorica
