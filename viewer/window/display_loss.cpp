#include "viewer/window/display_loss.h"

#include "geometry/hard_stop.h"

#include <dlfcn.h>
#include <unistd.h>

#include <string_view>

namespace lorica {
namespace {

constexpr int kExitStatus = 2;
constexpr std::string_view kSentence = "lorica: the connection to the display was lost\n";

/// Must not return.
int onLoss(void* /*display*/) {
  runHardStop();
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, kSentence.data(), kSentence.size());
  _exit(kExitStatus);
}

}  // namespace

void endWithDisplay() {
  // GLFW has loaded libX11, which viewer/ is not linked with: there may be Wayland instead. GLFW 3.4 opens it for
  // itself, so its functions are not found among those of the program.
  void* x11 = dlopen("libX11.so.6", RTLD_LAZY | RTLD_NOLOAD);
  if (x11 == nullptr) return;
  using Handler = int (*)(void*);
  using SetHandler = Handler (*)(Handler);
  const auto set = reinterpret_cast<SetHandler>(dlsym(x11, "XSetIOErrorHandler"));
  if (set != nullptr) set(onLoss);
}

}  // namespace lorica
