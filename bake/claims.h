#pragma once

#include "bake/file_layer.h"

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace lorica {

/// Who does which item, agreed by files in a folder that several processes on several machines share.
///
/// A claim is the file claims/KEY.0, which only one process can create, with the name of its worker in it. A worker is
/// a file with a number that grows while its process lives. If the process is lost, another one creates claims/KEY.1,
/// and so on: the highest number counts, and nothing is removed of an item that is not done. A worker is lost if it
/// said that it ended, if its process is gone from this machine, or if its file did not change for a time that this
/// process has watched it. Clocks of machines and times of files are never compared.
class Claims {
 public:
  using Clock = std::chrono::steady_clock;

  /// Makes the folders and this process's worker file.
  /// @param lostAfter  how long a worker's file may stay the same [s]
  /// @param now        for tests; only differences count
  [[nodiscard]] static Result<Claims> open(FileLayer& files, const std::filesystem::path& folder, double lostAfter,
                                           std::function<Clock::time_point()> now = Clock::now);

  /// Claims an item. @return the number of processes that had it before and were lost; none if another one has it; or
  /// that the claim cannot be written
  [[nodiscard]] Result<std::optional<int>> claim(const std::string& key);

  /// Removes all claims of a claimed item that is done. Whoever claims it nevertheless finds it done.
  void release(const std::string& key);

  /// Says that this process lives, if it is time for that. To be called often.
  void beat();
  /// Says that it has ended: what it had claimed and not done may be claimed by others at once. Folders in which
  /// nothing is left go.
  void end();

  [[nodiscard]] const std::string& worker() const { return worker_; }

 private:
  Claims(FileLayer& files, std::filesystem::path folder, double lostAfter, std::function<Clock::time_point()> now);
  [[nodiscard]] int createIn(const char* name, const std::filesystem::path& file, std::string_view content);
  [[nodiscard]] bool lost(const std::string& worker, const std::filesystem::path& claim);
  [[nodiscard]] std::filesystem::path fileOf(const std::string& worker) const;
  [[nodiscard]] std::string lifeSign() const;

  struct Seen {
    std::string sign;
    Clock::time_point since;
  };

  FileLayer* files_;
  std::filesystem::path folder_;
  double lostAfter_;
  std::function<Clock::time_point()> now_;
  std::string worker_;
  long beats_ = 0;
  std::map<std::string, int> held_;  ///< items claimed and not released, and how many processes had them before
  Clock::time_point lastBeat_;
  std::map<std::string, Seen> seen_;  // of each other worker, or claim without a name: when its file last changed
};

}  // namespace lorica
