#pragma once

/// A folder from which OpenNI2 loads drivers. Internal: not installed.

#include "capture/sensor/openni.h"
#include "geometry/hard_stop.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace lorica {

/// OpenNI2 looks for drivers, files named lib*.so.0, in OpenNI2/Drivers beside the path from which it was itself
/// loaded, without following links. A private folder with links to the library, its own drivers and the user's drivers
/// therefore makes it find all of them, without an environment variable and without changes to the system.
class OpenNiStage {
 public:
  /// Creates the folder in the temporary directory. The user's drivers are loaded once, so that problems can be
  /// reported, and so that they find their own libraries beside their real files.
  /// @param library  libOpenNI2.so.0
  [[nodiscard]] static Result<std::unique_ptr<OpenNiStage>> make(const std::filesystem::path& library,
                                                                 const std::vector<std::filesystem::path>& drivers);
  /// Removes the folder, but only in the process that created it.
  ~OpenNiStage();
  OpenNiStage(const OpenNiStage&) = delete;
  OpenNiStage& operator=(const OpenNiStage&) = delete;

  [[nodiscard]] std::filesystem::path library() const { return folder_ / "libOpenNI2.so.0"; }
  [[nodiscard]] const std::vector<OpenNiDriver>& drivers() const { return drivers_; }

 private:
  OpenNiStage() = default;
  Result<void> link(const std::filesystem::path& from, const std::filesystem::path& to) const;

  std::filesystem::path folder_;
  int owner_ = 0;  ///< process ID
  std::vector<OpenNiDriver> drivers_;
  std::optional<AtHardStop> cleaning_;
};

}  // namespace lorica
