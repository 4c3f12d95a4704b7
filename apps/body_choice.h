#pragma once

#include "acd/decomposition_file.h"
#include "apps/command_line.h"
#include "apps/cover_options.h"
#include "apps/inputs.h"

#include <string>

namespace lorica {

/// Which body a character plays with.
struct BodyOptions {
  std::string decomposition;  ///< file; empty = the default one, see defaultDecomposition()
  CoverRequest cover;         ///< not given = as the file has it
};

/// --decomposition, --cover, --hull-vertices.
void addBodyOptions(CommandLine& app, BodyOptions& options);

/// The decomposition with the cover that was asked for; without a request its own, exact where it has none.
/// @param subject  a character
/// @return the body; or that the file was made from another mesh or cannot be read
[[nodiscard]] Result<DecompositionFile> chooseBody(const BodyOptions& options, const Subject& subject, int threads);

}  // namespace lorica
