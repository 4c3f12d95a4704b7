#pragma once

#include "tests/apps/run_command.h"
#include "tests/support/datasets.h"
#include "viewer/pictures/image_files.h"

#include <functional>
#include <string>
#include <vector>

namespace lorica::test {

/// The number of pixels that differ visibly; -1 for pictures of different sizes.
[[nodiscard]] int differing(const Image& a, const Image& b);

/// Presses keys in a window of the command while it runs. Waits for what can be seen, never for a time. Each run
/// has a display of its own, so that no key stays pressed for the next one.
class Hands {
 public:
  /// @param window  its title: that of a session, or "^Lorica" for one that still loads as well
  explicit Hands(const TemporaryFolder& folder, std::string window = "^Lorica: ");

  void line(const std::string& command) {
    steps_.push_back([command] { run(command); });
  }
  void press(const std::string& keys) { line("xdotool key " + keys); }
  void mouse(const std::string& what) { line("xdotool " + what); }
  /// Waits for the session of a motion.
  void session(const std::string& motion) { line("xdotool search --sync --name '^Lorica: " + motion + "'"); }
  /// Waits until several pictures show all that was done so far, and drops them.
  void handled();

  /// Takes a picture of all that was done so far.
  void picture(const std::string& key = "p");
  /// Takes pictures until one is as it should be.
  void pictureWhen(const std::function<bool(const Image&)>& wanted, const std::string& key = "p");
  /// Takes pictures until one differs in more pixels than this from an earlier one.
  void pictureUnlike(int earlier, int pixels, const std::string& key = "p");
  /// Takes pictures until several in a row are equal: what moves and the camera have come to rest.
  void pictureAtRest(const std::string& key = "p");

  /// Does all this in parallel with the command, and closes its window.
  CommandResult runWith(const std::vector<std::string>& arguments);
  /// What was done in the last run, and its output.
  [[nodiscard]] const std::string& said() const { return said_; }
  [[nodiscard]] Image pictureNumber(int n) const;

  CommandSurroundings surroundings;  ///< of the command; the display comes with the run

 private:
  static void run(const std::string& command);
  [[nodiscard]] std::filesystem::path file(int n) const;
  [[nodiscard]] Image shoot(int n, const std::string& key) const;
  void work() const;

  const TemporaryFolder& folder_;
  std::string window_;
  std::vector<std::function<void()>> steps_;
  std::string said_;
  int pictures_ = 0;
};

}  // namespace lorica::test
