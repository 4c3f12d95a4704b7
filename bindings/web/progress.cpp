// The one function of its own that the module has: what a decomposition calls is a function of the page.
#include <cstdint>

extern "C" {

__attribute__((import_module("lorica"), import_name("progress"))) int loricaPageProgress(std::int32_t done,
                                                                                         std::int32_t wanted);

/// For lorica_decompose_options.progress.
int (*progress_function())(void*, std::int32_t, std::int32_t) {
  return [](void* /*user*/, std::int32_t done, std::int32_t wanted) { return loricaPageProgress(done, wanted); };
}
}
