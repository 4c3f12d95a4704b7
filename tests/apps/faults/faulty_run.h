#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lorica::test {

/// What happens to a running command.
enum class Fault {
  kNone,
  kInterrupt,
  kTerminate,
  kHangUp,
  kKill,
  kDiskFull,  ///< no file may have more than 64 bytes, unless the folder is on a disk that is full
  kOutputClosed,
  kErrorsClosed,
  kReadOnly,
  kServerAway,   ///< what is written to the working folder fails: not under sanitizers, see hasShim()
  kServerHangs,  ///< it waits for ever, and SIGTERM comes
  kClockWrong    ///< the machine's clock says 1970 and runs backwards
};

[[nodiscard]] const char* nameOf(Fault fault);

struct FaultyRun {
  std::vector<std::string> arguments;  ///< after `lorica`
  std::filesystem::path folder;        ///< working folder
  std::filesystem::path cache;         ///< XDG_CACHE_HOME
  Fault fault = Fault::kNone;
  /// Signals are sent as soon as this holds; empty = 0.25 s after the start.
  std::function<bool()> ready = {};
  std::string program = {};                                           ///< another one than `lorica`
  std::vector<std::pair<std::string, std::string>> environment = {};  ///< set besides
};

struct FaultyEnd {
  int exitCode = -1;  ///< 128 + the signal's number if a signal ended it
  bool bySignal = false;
  double secondsAfterSignal = 0.0;
  std::string out, err;
};

/// Whether faults of servers and clocks can be made: a library that is loaded first, which sanitizers do not like.
[[nodiscard]] bool hasShim();

/// Does work in a process of its own that sees a folder as a disk of a few megabytes, which is empty and can be filled.
/// @return whether what it expected holds; nothing, after the reason was printed, where the kernel makes no such disk
[[nodiscard]] std::optional<bool> onDiskOfItsOwn(const std::filesystem::path& folder, int megabytes,
                                                 const std::function<void()>& work);
/// Fills it to the last byte, with a file of this name.
inline constexpr const char* kFiller = "filler";
void fillDisk(const std::filesystem::path& folder);

/// Runs the command with a fault. Its temporary folder is `folder`/tmp.
[[nodiscard]] FaultyEnd runWithFault(const FaultyRun& run);

}  // namespace lorica::test
