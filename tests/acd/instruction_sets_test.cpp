#include <dlfcn.h>
#include <gtest/gtest.h>
#include <hwy/targets.h>

namespace lorica {
namespace {

TEST(InstructionSets, AreThoseThatHighwaysLibraryFinds) {
  void* library = dlopen("libhwy.so.1", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) GTEST_SKIP() << dlerror();
  void* symbol = dlsym(library, "_ZN3hwy16SupportedTargetsEv");
  ASSERT_NE(symbol, nullptr) << dlerror();
  const auto theirs = reinterpret_cast<std::int64_t (*)()>(symbol);
  ASSERT_NE(theirs, &hwy::SupportedTargets) << "the library's own";
#if HWY_ARCH_X86
  constexpr std::int64_t kOurs = HWY_SSSE3 | HWY_SSE4 | HWY_AVX2 | HWY_AVX3 | HWY_AVX3_DL;
  EXPECT_EQ(hwy::SupportedTargets() & kOurs, theirs() & kOurs);
#endif
  EXPECT_NE(hwy::SupportedTargets() & HWY_TARGETS, 0);
}

}  // namespace
}  // namespace lorica
