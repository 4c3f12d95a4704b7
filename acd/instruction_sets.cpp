// Highway's functions that say which instruction sets there are. They stand here so that its library is not loaded:
// that measures a timer for 3 ms whenever a program starts, whether or not it uses vectors.

#include <hwy/targets.h>

#if HWY_ARCH_X86
#include "geometry/system_processor.h"
#endif

namespace hwy {
namespace {

int64_t g_disabled = 0;
int64_t g_forTest = 0;

// What each of Highway's targets uses, as it compiles them.
int64_t targetsOfThisMachine() {
  int64_t targets = HWY_STATIC_TARGET;
#if HWY_ARCH_X86
  const bool ssse3 = LORICA_ACTIVE(SSSE3);
  const bool sse4 =
      ssse3 && LORICA_ACTIVE(SSE4_1) && LORICA_ACTIVE(SSE4_2) && LORICA_ACTIVE(PCLMULQDQ) && LORICA_ACTIVE(AES);
  const bool avx2 = sse4 && LORICA_ACTIVE(AVX) && LORICA_ACTIVE(AVX2) && LORICA_ACTIVE(LZCNT) && LORICA_ACTIVE(BMI1) &&
                    LORICA_ACTIVE(BMI2) && LORICA_ACTIVE(FMA) && LORICA_ACTIVE(F16C);
  const bool avx3 = avx2 && LORICA_ACTIVE(AVX512F) && LORICA_ACTIVE(AVX512CD) && LORICA_ACTIVE(AVX512DQ) &&
                    LORICA_ACTIVE(AVX512BW) && LORICA_ACTIVE(AVX512VL);
  const bool avx3Dl = avx3 && LORICA_ACTIVE(AVX512_VNNI) && LORICA_ACTIVE(VPCLMULQDQ) && LORICA_ACTIVE(AVX512_VBMI) &&
                      LORICA_ACTIVE(AVX512_VBMI2) && LORICA_ACTIVE(VAES) && LORICA_ACTIVE(AVX512_VPOPCNTDQ) &&
                      LORICA_ACTIVE(AVX512_BITALG) && LORICA_ACTIVE(GFNI);
  if (ssse3) targets |= HWY_SSSE3;
  if (sse4) targets |= HWY_SSE4;
  if (avx2) targets |= HWY_AVX2;
  if (avx3) targets |= HWY_AVX3;
  if (avx3Dl) targets |= HWY_AVX3_DL;
#endif
  return targets;
}

}  // namespace

int64_t SupportedTargets() {
  const int64_t targets = (g_forTest != 0 ? g_forTest : targetsOfThisMachine()) & ~g_disabled;
  return targets != 0 ? targets : HWY_STATIC_TARGET;
}

void DisableTargets(int64_t disabled) {
  g_disabled = disabled & ~static_cast<int64_t>(HWY_STATIC_TARGET);
  GetChosenTarget().DeInit();
}

void SetSupportedTargetsForTest(int64_t targets) {
  g_forTest = targets;
  GetChosenTarget().DeInit();
}

ChosenTarget& GetChosenTarget() {
  static ChosenTarget chosen;
  return chosen;
}

}  // namespace hwy
