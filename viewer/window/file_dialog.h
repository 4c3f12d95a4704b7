#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace lorica {

/// The desktop's dialogue for opening files: that of zenity, which is GTK's and so the portal's, or of kdialog. It runs
/// in a process of its own; the window goes on.
class FileDialog {
 public:
  FileDialog() = default;
  ~FileDialog() { close(); }
  FileDialog(const FileDialog&) = delete;
  FileDialog& operator=(const FileDialog&) = delete;

  /// Shows it, in the working folder, unless it is there already. @return whether this desktop has one
  [[nodiscard]] bool open();
  [[nodiscard]] bool isOpen() const { return process_ > 0; }
  /// Adds the files that the user chose since the last call. Does not wait.
  void take(std::vector<std::string>& files);

 private:
  void close();

  pid_t process_ = 0;  // 0 = none
  int answer_ = -1;    // its standard output
  std::string answered_;
};

}  // namespace lorica
