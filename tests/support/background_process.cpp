#include "tests/support/background_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

namespace lorica::test {

BackgroundProcess::BackgroundProcess(const std::function<void()>& work, const std::filesystem::path& log) {
  group_ = fork();
  if (group_ == 0) {
    setpgid(0, 0);
    const int output = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    work();
    _exit(0);
  }
  setpgid(group_, group_);  // whoever comes first, so that it can be killed from now on
}

BackgroundProcess::~BackgroundProcess() {
  if (group_ <= 0) return;
  kill(-group_, SIGKILL);
  waitpid(group_, nullptr, 0);
}

}  // namespace lorica::test
