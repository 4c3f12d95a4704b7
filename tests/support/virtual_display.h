#pragma once

#include <sys/types.h>

#include <string>

namespace lorica::test {

/// Runs a virtual X server during its lifetime; DISPLAY refers to it.
class VirtualDisplay {
 public:
  /// @param pictures  a folder in whose Xvfb_screen0 (XWD) it keeps what it shows; empty = nowhere
  explicit VirtualDisplay(const std::string& pictures = {});
  ~VirtualDisplay();
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;

  [[nodiscard]] bool ready() const { return !name_.empty(); }
  /// The value of DISPLAY: ":99".
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  pid_t pid_ = -1;
  std::string name_;
};

/// Whether a program can be started by this name.
[[nodiscard]] bool installed(const std::string& program);

}  // namespace lorica::test

/// Skips the test with a message if windows cannot be opened or keys not be pressed.
#define LORICA_REQUIRE_KEYS()                                                      \
  if (!::lorica::test::installed("Xvfb") || !::lorica::test::installed("xdotool")) \
  GTEST_SKIP() << "Xvfb or xdotool is not installed (Debian packages xvfb, xdotool)"
