// Highway 1.0 for WebAssembly, with the double precision that it lacks there: each operation as its reference says
// (https://google.github.io/highway/en/master/quick_reference.html), for what Lorica's kernels use.
#pragma once
#include_next <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hwy::HWY_NAMESPACE {

template <size_t N>
using Doubles128 = Vec128<double, N>;

#define LORICA_OF_TWO(name, intrinsic)                                       \
  template <size_t N>                                                        \
  HWY_API Doubles128<N> name(const Doubles128<N> a, const Doubles128<N> b) { \
    return {intrinsic(a.raw, b.raw)};                                        \
  }
LORICA_OF_TWO(operator+, wasm_f64x2_add)
LORICA_OF_TWO(operator-, wasm_f64x2_sub)
LORICA_OF_TWO(operator*, wasm_f64x2_mul)
LORICA_OF_TWO(operator/, wasm_f64x2_div)
#undef LORICA_OF_TWO

// Of equal ones the second, as on x86: -0 is as large as 0.
template <size_t N>
HWY_API Doubles128<N> Min(const Doubles128<N> a, const Doubles128<N> b) {
  return {wasm_f64x2_pmin(b.raw, a.raw)};
}

template <size_t N>
HWY_API Doubles128<N> Max(const Doubles128<N> a, const Doubles128<N> b) {
  return {wasm_f64x2_pmax(b.raw, a.raw)};
}

#define LORICA_COMPARED(name, intrinsic)                                          \
  template <size_t N>                                                             \
  HWY_API Mask128<double, N> name(const Doubles128<N> a, const Doubles128<N> b) { \
    return {intrinsic(a.raw, b.raw)};                                             \
  }
LORICA_COMPARED(operator<, wasm_f64x2_lt)
LORICA_COMPARED(operator<=, wasm_f64x2_le)
LORICA_COMPARED(operator>, wasm_f64x2_gt)
LORICA_COMPARED(operator>=, wasm_f64x2_ge)
LORICA_COMPARED(operator==, wasm_f64x2_eq)
#undef LORICA_COMPARED

template <size_t N>
HWY_API Doubles128<N> Set(Simd<double, N, 0> /* tag */, const double value) {
  return {wasm_f64x2_splat(value)};
}

template <size_t N>
HWY_API Doubles128<N> Abs(const Doubles128<N> v) {
  return {wasm_f64x2_abs(v.raw)};
}

template <size_t N>
HWY_API Doubles128<N> Neg(const Doubles128<N> v) {
  return {wasm_f64x2_neg(v.raw)};
}

template <size_t N>
HWY_API Doubles128<N> Sqrt(const Doubles128<N> v) {
  return {wasm_f64x2_sqrt(v.raw)};
}

template <size_t N>
HWY_API double GetLane(const Doubles128<N> v) {
  return wasm_f64x2_extract_lane(v.raw, 0);
}

HWY_API Doubles128<2> MinOfLanes(Simd<double, 2, 0> /* tag */, const Doubles128<2> v) {
  return Min(v, Doubles128<2>{wasm_i64x2_shuffle(v.raw, v.raw, 1, 0)});
}

HWY_API Doubles128<2> MaxOfLanes(Simd<double, 2, 0> /* tag */, const Doubles128<2> v) {
  return Max(v, Doubles128<2>{wasm_i64x2_shuffle(v.raw, v.raw, 1, 0)});
}

template <size_t N>
HWY_API Vec128<float, N> DemoteTo(Simd<float, N, 0> /* tag */, const Doubles128<N> v) {
  return Vec128<float, N>{wasm_f32x4_demote_f64x2_zero(v.raw)};
}

template <size_t N>
HWY_API Doubles128<N> PromoteTo(Simd<double, N, 0> /* tag */, const Vec128<float, N> v) {
  return {wasm_f64x2_promote_low_f32x4(v.raw)};
}

HWY_API void LoadInterleaved3(Simd<double, 2, 0> /* tag */, const double* from, Doubles128<2>& x, Doubles128<2>& y,
                              Doubles128<2>& z) {
  const v128_t a = wasm_v128_load(from), b = wasm_v128_load(from + 2), c = wasm_v128_load(from + 4);
  x.raw = wasm_i64x2_shuffle(a, b, 0, 3);
  y.raw = wasm_i64x2_shuffle(a, c, 1, 2);
  z.raw = wasm_i64x2_shuffle(b, c, 0, 3);
}

}  // namespace hwy::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
