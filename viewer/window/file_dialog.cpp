#include "viewer/window/file_dialog.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <filesystem>
#include <sstream>
#include <system_error>

extern char** environ;

namespace lorica {
namespace {

/// Characters, motions and recordings, scenes, meshes.
constexpr const char* kOpened =
    "*.vrm *.glb *.gltf *.fbx *.dae *.bvh *.csv *.vrma *.lsession *.oni *.mkv *.bag *.npz *.json *.obj *.off *.ply "
    "*.stl";

/// Starts a program found in $PATH. @param output  becomes its standard output @return its process, 0 = it is not there
pid_t start(std::vector<const char*> command, int output) {
  command.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  pid_t process = 0;
  const int failed =
      posix_spawnp(&process, command[0], &actions, nullptr, const_cast<char* const*>(command.data()), environ);
  posix_spawn_file_actions_destroy(&actions);
  return failed == 0 ? process : 0;
}

}  // namespace

bool FileDialog::open() {
  if (process_ > 0) return true;
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return false;
  std::error_code none;
  const std::string here = std::filesystem::current_path(none).string() + "/";
  const std::string from = "--filename=" + here, only = std::string("--file-filter=What Lorica opens | ") + kOpened;
  process_ = start({"zenity", "--file-selection", "--multiple", "--separator=\n", "--title=Open in Lorica",
                    from.c_str(), only.c_str(), "--file-filter=All files | *"},
                   ends[1]);
  if (process_ == 0) {
    const std::string filters = std::string(kOpened) + "|What Lorica opens\n*|All files";
    process_ = start({"kdialog", "--multiple", "--separate-output", "--title", "Open in Lorica", "--getopenfilename",
                      here.c_str(), filters.c_str()},
                     ends[1]);
  }
  ::close(ends[1]);
  fcntl(ends[0], F_SETFL, O_NONBLOCK);
  answer_ = ends[0];
  if (process_ == 0) close();
  return process_ > 0;
}

void FileDialog::take(std::vector<std::string>& files) {
  if (process_ == 0) return;
  std::array<char, 4096> some{};
  ssize_t got = 0;
  while ((got = read(answer_, some.data(), some.size())) > 0) answered_.append(some.data(), got);
  if (got != 0) return;  // it is still open
  std::istringstream lines(answered_);
  for (std::string file; std::getline(lines, file);) {
    if (!file.empty()) files.push_back(file);
  }
  close();
}

void FileDialog::close() {
  if (process_ > 0) {
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
  }
  if (answer_ >= 0) ::close(answer_);
  process_ = 0;
  answer_ = -1;
  answered_.clear();
}

}  // namespace lorica
