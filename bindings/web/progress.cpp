// What the module has of its own: what a decomposition calls is a function of the page, and nothing is printed.
#include <cstdint>
#include <cstdio>

extern "C" {

__attribute__((import_module("lorica"), import_name("progress"))) int loricaPageProgress(std::int32_t done,
                                                                                         std::int32_t wanted);

/// For lorica_decompose_options.progress.
int (*progress_function())(void*, std::int32_t, std::int32_t) {
  return [](void* /*user*/, std::int32_t done, std::int32_t wanted) { return loricaPageProgress(done, wanted); };
}

// In place of the C library's, which are 3 kB on their way to a page. There is no stderr, where LORICA_CHECK prints
// before it ends the module; {fmt} asks for hexadecimal fractions only, which Lorica writes none of.
int fprintf(std::FILE* /*file*/, const char* /*format*/, ...) {
  return 0;
}
int fiprintf(std::FILE* /*file*/, const char* /*format*/, ...) {
  return 0;
}
int snprintf(char* /*text*/, std::size_t /*size*/, const char* /*format*/, ...) {
  return 0;
}
}
