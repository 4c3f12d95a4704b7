#include "tests/support/background_script.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <string>
#include <thread>

namespace lorica::test {

BackgroundScript::BackgroundScript(const std::filesystem::path& script, int seconds, const std::filesystem::path& log) {
  const std::string limit = std::to_string(seconds), folder = script.parent_path();
  group_ = fork();
  if (group_ == 0) {
    setpgid(0, 0);
    const int output = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    if (chdir(folder.c_str()) != 0) _exit(126);
    execlp("timeout", "timeout", limit.c_str(), "sh", "-x", script.c_str(), nullptr);
    _exit(127);
  }
  setpgid(group_, group_);  // whoever comes first, so that it can be killed from now on
}

BackgroundScript::~BackgroundScript() {
  if (group_ <= 0) return;
  for (int waited = 0; waited < 200; ++waited) {
    if (waitpid(group_, nullptr, WNOHANG) != 0) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  kill(-group_, SIGKILL);
  waitpid(group_, nullptr, 0);
}

}  // namespace lorica::test
