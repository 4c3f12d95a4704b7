#pragma once

#include "export/bake/bake_job.h"
#include "export/bake/bake_store.h"

#include <functional>
#include <span>

namespace lorica {

/// How items are made.
struct ItemSettings {
  std::filesystem::path program;  ///< this program: it runs itself, so that a crash costs one item
  int threads = 1;                ///< of one item
  double timeout = 3600.0;        ///< of one item [s]
  bool trustPaths = false;        ///< see NamedFiles
};

/// The arguments with which this program exports an item's decomposition.
/// @param lorica  the decomposition
[[nodiscard]] std::vector<std::string> exportArguments(const BakeItem& item, const std::filesystem::path& lorica,
                                                       const std::filesystem::path& out, const ItemSettings& settings);

struct BakerSettings {
  ItemSettings item;
  int jobs = 1;              ///< items at a time
  std::uint64_t memory = 0;  ///< that all items together may take, by memoryBound() [bytes]
  bool retryFailed = false;  ///< do items again that have failed
  /// Whether to begin no more items: those in progress are finished.
  std::function<bool()> stopping = [] { return false; };
  /// Called often, with the items that were not there before.
  /// @param share  of the work, as far as the sizes of the items tell
  std::function<void(int done, int total, double share)> progress = [](int, int, double) {};
};

/// What became of the items of a list.
struct BakeOutcome {
  int items = 0;
  int there = 0;                      ///< done before
  int made = 0;                       ///< by this process
  int failed = 0;                     ///< in this process: results without files
  int byOthers = 0;                   ///< done by other processes meanwhile
  std::vector<std::string> tooLarge;  ///< left out: a sentence for each that may take more than all memory
  bool stopped = false;               ///< some were not started
  double seconds = 0.0;
  double cpuSeconds = 0.0;        ///< of the items of this process
  double longest = 0.0;           ///< of them [s]
  std::uint64_t peakMemory = 0;   ///< largest of one of them [bytes]
  std::uint64_t memoryBound = 0;  ///< largest of all items [bytes]
};

/// Makes all items that are not there yet or are damaged, large ones first, several at a time. What another process
/// makes meanwhile may be made twice; the first result stays. If the program is ended (geometry/hard_stop.h), items in
/// progress are dropped.
/// @return the outcome, or an error of the machine: a full disk, say. Then items in progress are dropped
[[nodiscard]] Result<BakeOutcome> bakeAll(std::span<const BakeJob> jobs, const BakeStore& store,
                                          const BakerSettings& settings);

}  // namespace lorica
