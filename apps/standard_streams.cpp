#include "apps/standard_streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <system_error>

#include "geometry/descriptor.h"
#include "geometry/errors.h"

namespace lorica {
void openStandardStreams() {
  // The lowest free number is used, which is that of the missing stream.
  int descriptor = 0;
  while (descriptor <= STDERR_FILENO) {
    descriptor = ::open("/dev/null", O_RDONLY);
    if (descriptor < 0) return;
  }
  ::close(descriptor);
}

void say(std::string_view text) {
  (void)writeAll(STDERR_FILENO, text);
}

Result<void> print(std::string_view text, std::string_view what) {
  const int error = writeAll(STDOUT_FILENO, text);
  if (error == 0) return {};
  return unwritable("standard output: could not write {}: {}", what, std::generic_category().message(error));
}

}  // namespace lorica
