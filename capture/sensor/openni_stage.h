#pragma once

/// A folder from which OpenNI2 loads drivers. Internal: not installed.

#include "capture/sensor/openni.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace lorica {

/// OpenNI2 looks for drivers in OpenNI2/Drivers beside the path by which it was itself loaded, links not followed, for
/// files named lib*.so.0. So a private folder with links to the library, its own drivers and the user's makes it find
/// them all, without an environment variable and without touching the system.
class OpenNiStage {
 public:
  /// Makes the folder, where temporary files go. User's drivers are loaded once, so that what is wrong with one can be
  /// said, and so that they find their own libraries beside the file they really are.
  /// @param library  libOpenNI2.so.0
  [[nodiscard]] static Result<std::unique_ptr<OpenNiStage>> make(const std::filesystem::path& library,
                                                                 const std::vector<std::filesystem::path>& drivers);
  /// Removes the folder, in the process that made it.
  ~OpenNiStage();
  OpenNiStage(const OpenNiStage&) = delete;
  OpenNiStage& operator=(const OpenNiStage&) = delete;

  [[nodiscard]] std::filesystem::path library() const { return folder_ / "libOpenNI2.so.0"; }
  [[nodiscard]] const std::vector<OpenNiDriver>& drivers() const { return drivers_; }

 private:
  OpenNiStage() = default;
  Result<void> link(const std::filesystem::path& from, const std::filesystem::path& to) const;

  std::filesystem::path folder_;
  int owner_ = 0;  ///< process
  std::vector<OpenNiDriver> drivers_;
};

}  // namespace lorica
