#pragma once

#include "acd/decompose.h"
#include "acd/hull_budget.h"
#include "collision/hulls/host.h"
#include "geometry/result.h"

#include <atomic>
#include <optional>
#include <string>

namespace lorica {

/// Refuses numbers that a program asks for and no machine can give. 0 is the default of each.
/// @param budget  its limits are at least 4, or 0 for no limit
[[nodiscard]] Result<void> checkCounts(int parts, const HullBudget& budget, int threads);

/// What reads FBX and COLLADA files: the program lorica_character_reader, which lies where this library's modules do.
/// If it is missing, reading these formats fails with its name.
[[nodiscard]] std::optional<IsolatedReader> characterReader();

/// The program that calls the library, as a host of work: its threads, its progress function and characterReader().
class ProgramHost final : public Host {
 public:
  /// @param progress  counts parts; called for other work with 0 parts done, so that this can be cancelled too
  /// @param parts     wanted, as far as that is known before; 0 = unknown
  explicit ProgramHost(const DecomposeProgress& progress = {}, int threads = 0, int parts = 0);

  void beginTask(const std::string& label, const std::string& unit) override;
  void report(int done, int total, double share) override;
  [[nodiscard]] bool cancelled() const override { return cancelled_; }

 private:
  DecomposeProgress progress_;
  int parts_;
  bool counted_ = false;  // the task counts parts
  std::atomic<bool> cancelled_ = false;
};

}  // namespace lorica
