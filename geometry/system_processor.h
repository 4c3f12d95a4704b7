#pragma once

// Whether the processor and the system have an instruction set, by glibc's names: LORICA_ACTIVE(AVX2).
// For sources for x86 alone. glibc's own answer needs no start-up and is the same with each compiler; elsewhere the
// compiler's is asked.

#if __has_include(<sys/platform/x86.h>)

#define _Bool bool  // NOLINT: a header for C, which clang takes by the letter
#include <sys/platform/x86.h>
#undef _Bool
#define LORICA_ACTIVE(name) CPU_FEATURE_ACTIVE(name)

#else

#define LORICA_ACTIVE(name) (__builtin_cpu_supports(LORICA_NAME_##name) != 0)
#define LORICA_NAME_SSSE3 "ssse3"
#define LORICA_NAME_SSE4_1 "sse4.1"
#define LORICA_NAME_SSE4_2 "sse4.2"
#define LORICA_NAME_PCLMULQDQ "pclmul"
#define LORICA_NAME_AES "aes"
#define LORICA_NAME_AVX "avx"
#define LORICA_NAME_AVX2 "avx2"
#define LORICA_NAME_LZCNT "lzcnt"
#define LORICA_NAME_BMI1 "bmi"
#define LORICA_NAME_BMI2 "bmi2"
#define LORICA_NAME_FMA "fma"
#define LORICA_NAME_F16C "f16c"
#define LORICA_NAME_AVX512F "avx512f"
#define LORICA_NAME_AVX512CD "avx512cd"
#define LORICA_NAME_AVX512DQ "avx512dq"
#define LORICA_NAME_AVX512BW "avx512bw"
#define LORICA_NAME_AVX512VL "avx512vl"
#define LORICA_NAME_AVX512_VNNI "avx512vnni"
#define LORICA_NAME_VPCLMULQDQ "vpclmulqdq"
#define LORICA_NAME_AVX512_VBMI "avx512vbmi"
#define LORICA_NAME_AVX512_VBMI2 "avx512vbmi2"
#define LORICA_NAME_VAES "vaes"
#define LORICA_NAME_AVX512_VPOPCNTDQ "avx512vpopcntdq"
#define LORICA_NAME_AVX512_BITALG "avx512bitalg"
#define LORICA_NAME_GFNI "gfni"

#endif
