#pragma once

#include "bake/bake_job.h"
#include "bake/bake_store.h"
#include "bake/child_process.h"

#include <nlohmann/json.hpp>

#include <chrono>

namespace lorica {

/// How items are made.
struct ItemRunSettings {
  std::filesystem::path program;  ///< this program: it runs itself, so that a crash costs one item
  int threads = 1;                ///< of one item
  double timeout = 3600.0;        ///< of one item [s]
  bool trustPaths = false;        ///< see NamedFiles
};

/// The arguments with which this program exports an item's decomposition.
/// @param lorica  the decomposition
[[nodiscard]] std::vector<std::string> exportArguments(const BakeItem& item, const std::filesystem::path& lorica,
                                                       const std::filesystem::path& out,
                                                       const ItemRunSettings& settings);

/// One item being made, by processes one after the other: `decompose`, then an `export` for each file.
class ItemRun {
 public:
  /// @param folder  empty; gets the files of the result
  [[nodiscard]] static Result<ItemRun> start(const BakeJob& job, const std::filesystem::path& folder,
                                             const ItemRunSettings& settings);

  /// Starts the next process if one has ended. @return the description of the result, when all have or one failed;
  /// none while it works; or an error of this machine, not of the item
  [[nodiscard]] Result<std::optional<nlohmann::ordered_json>> poll();

  [[nodiscard]] const BakeJob& job() const { return job_; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  using Clock = std::chrono::steady_clock;
  ItemRun(BakeJob job, std::filesystem::path folder, ItemRunSettings settings);
  [[nodiscard]] Result<void> startStep();
  [[nodiscard]] Result<nlohmann::ordered_json> finish(const std::string& failure);
  /// Whether the end says something about the item: not if the disk is full, a file server away, or the process was
  /// killed from outside.
  [[nodiscard]] Result<void> checkMachine(const ProcessEnd& end) const;
  /// Why a process refused its work, of its report; empty without one.
  struct Refusal {
    std::string kind;  ///< see nameOf(ErrorCode)
    std::string message;
  };
  [[nodiscard]] Refusal refusal() const;
  /// Why there is no result, as a sentence; empty if nothing failed.
  [[nodiscard]] std::string failureOf(const ProcessEnd& end) const;
  [[nodiscard]] std::string lastSentence() const;

  BakeJob job_;
  std::filesystem::path folder_;
  ItemRunSettings settings_;
  std::vector<std::vector<std::string>> steps_;  // arguments of each process
  std::size_t step_ = 0;
  std::optional<ChildProcess> process_;
  Clock::time_point begin_;
  double cpuSeconds_ = 0.0;
  std::uint64_t peakMemory_ = 0;
};

}  // namespace lorica
