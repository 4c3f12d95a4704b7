// Writes the surface of the mannequin, from which the library is built.

#include "geometry/files.h"
#include "tests/bench/generators/mannequin_surface.h"

#include <cstdio>

/// Usage: make_mannequin skinning/mannequin/mannequin.bin
int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "make_mannequin: found %d arguments, expected one file\n", argc - 1);
    return 2;
  }
  const lorica::Result<void> written = lorica::writeFileAtomically(argv[1], lorica::mannequinTable());
  if (!written) std::fprintf(stderr, "make_mannequin: %s\n", written.error().message.c_str());
  return written ? 0 : 2;
}
