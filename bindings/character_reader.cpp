// The program that reads FBX and COLLADA files for the C interface and the Python module (docs/SECURITY.md).
#include "skinning/import/character_file.h"

int main() {
  return lorica::serveIsolatedReader();
}
