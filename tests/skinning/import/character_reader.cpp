#include "skinning/import/character_file.h"

#include <unistd.h>
#include <string_view>

/// The process of IsolatedReader for tests, and processes that behave as a broken one may.
int main(int argc, char** argv) {
  const std::string_view how = argc > 1 ? argv[1] : "";
  if (how == "hang") pause();
  if (how == "lie") return ::write(STDOUT_FILENO, "\0\xff\xff\xff\xff truth", 11) == 11 ? 0 : 1;
  if (how == "silent") return 0;
  return lorica::serveIsolatedReader();
}
