#pragma once

#include "apps/command_line.h"
#include "bake/bake_job.h"

#include <string>
#include <vector>

namespace lorica {

/// Options of `lorica bake`.
struct BakeOptions {
  std::vector<std::string> lists;
  std::string out;
  std::string shard = "1/1";
  int jobs = 0;              ///< 0 = one for each thread
  std::string memory;        ///< "8G"; empty = what the machine has
  double timeout = 3600.0;   ///< of an item [s]
  double lostAfter = 120.0;  ///< see Claims [s]
  bool retryFailed = false;
  bool collect = false;

  // The usual ones of `lorica decompose`.
  std::string parts, maxError, maxDistance, maxConcavity, preset, cover, hullVertices, body, walls, thickness, engine;
  std::vector<std::string> motions, exports;
  bool exact = false;

  /// The settings of items whose list does not say otherwise; or an error that names the option.
  [[nodiscard]] Result<BakeSettings> defaults() const;
  [[nodiscard]] Shard chosenShard() const;
  /// Memory for all items at a time [bytes].
  [[nodiscard]] std::uint64_t memoryBytes() const;
};

void addBakeOptions(CommandLine& app, BakeOptions& options);

}  // namespace lorica
