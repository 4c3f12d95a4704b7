#include "collision/live/rotation_kernel.h"

// Highway compiles the code between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set. Not for
// vectors whose size is known only at run time: such vectors cannot be members of an array.
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/live/rotation_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lorica::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::CappedTag<double, MatrixBlock::kMatrices>;
using Double = hn::Vec<Doubles>;

constexpr double kSettled = 1e-8;  // a rotation after which the next one, its square, is below rounding
constexpr int kSteps = 5;

/// A matrix for each lane. No fused multiply-add, so that every instruction set rounds alike.
struct Matrix {
  Double m[3][3];
};

HWY_INLINE Double dot(Double a, Double x, Double b, Double y, Double c, Double z) {
  return hn::Add(hn::Add(hn::Mul(a, x), hn::Mul(b, y)), hn::Mul(c, z));
}

HWY_INLINE Double minor(Double a, Double d, Double b, Double c) {
  return hn::Sub(hn::Mul(a, d), hn::Mul(b, c));
}

HWY_INLINE Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      c.m[i][j] = dot(a.m[i][0], b.m[0][j], a.m[i][1], b.m[1][j], a.m[i][2], b.m[2][j]);
    }
  }
  return c;
}

HWY_INLINE Matrix transposed(const Matrix& a) {
  return {{{a.m[0][0], a.m[1][0], a.m[2][0]}, {a.m[0][1], a.m[1][1], a.m[2][1]}, {a.m[0][2], a.m[1][2], a.m[2][2]}}};
}

HWY_INLINE Double determinant(const Matrix& a) {
  return dot(a.m[0][0], minor(a.m[1][1], a.m[2][2], a.m[1][2], a.m[2][1]),  //
             a.m[0][1], minor(a.m[1][2], a.m[2][0], a.m[1][0], a.m[2][2]),  //
             a.m[0][2], minor(a.m[1][0], a.m[2][1], a.m[1][1], a.m[2][0]));
}

// The rotation nearest to one that has drifted a little: one Newton step of polar decomposition.
HWY_INLINE Matrix straightened(const Matrix& r) {
  const Doubles d;
  Matrix half = product(transposed(r), r);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      half.m[i][j] = hn::Sub(hn::Set(d, i == j ? 1.5 : 0.0), hn::Mul(hn::Set(d, 0.5), half.m[i][j]));
    }
  }
  return product(r, half);
}

// The rotation by a small vector t: that of the quaternion (2, t).
HWY_INLINE Matrix turnBy(Double x, Double y, Double z) {
  const Doubles d;
  const Double two = hn::Set(d, 2.0);
  const Double one = hn::Set(d, 1.0);
  const Double s = hn::Div(two, hn::Add(hn::Set(d, 4.0), dot(x, x, y, y, z, z)));
  const Double sx = hn::Mul(s, x), sy = hn::Mul(s, y), sz = hn::Mul(s, z);
  const Double wx = hn::Mul(two, sx), wy = hn::Mul(two, sy), wz = hn::Mul(two, sz);
  const Double xx = hn::Mul(sx, x), yy = hn::Mul(sy, y), zz = hn::Mul(sz, z);
  const Double xy = hn::Mul(sx, y), xz = hn::Mul(sx, z), yz = hn::Mul(sy, z);
  return {{{hn::Sub(one, hn::Add(yy, zz)), hn::Sub(xy, wz), hn::Add(xz, wy)},
           {hn::Add(xy, wz), hn::Sub(one, hn::Add(xx, zz)), hn::Sub(yz, wx)},
           {hn::Sub(xz, wy), hn::Add(yz, wx), hn::Sub(one, hn::Add(xx, yy))}}};
}

// Newton's steps to the rotation R that makes R^T covariance symmetric. It is the best one if that product is also
// positive definite.
// @return bits of the lanes in which it was found
HWY_INLINE std::uint32_t fitLanes(const Matrix& covariance, Matrix& r) {
  const Doubles d;
  const Double det = determinant(covariance);
  const Double half = hn::Set(d, 0.5);
  Double squares = hn::Zero(d);
  for (int i = 0; i < 3; ++i) {
    squares = hn::Add(squares, dot(covariance.m[i][0], covariance.m[i][0], covariance.m[i][1], covariance.m[i][1],
                                   covariance.m[i][2], covariance.m[i][2]));
  }
  const Double norm = hn::Sqrt(squares);
  const Double tiny = hn::Mul(hn::Set(d, kThinDeterminant), norm);
  const Double tinySq = hn::Mul(tiny, tiny);
  auto going = hn::Gt(det, hn::Mul(tiny, squares));
  auto found = hn::Lt(det, det);  // none yet
  r = straightened(r);
  for (int step = 0; step < kSteps && !hn::AllFalse(d, going); ++step) {
    const Matrix a = product(transposed(r), covariance);
    Matrix p;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) p.m[i][j] = hn::Mul(half, hn::Add(a.m[i][j], a.m[j][i]));
    }
    going = hn::And(going, hn::And(hn::Gt(p.m[0][0], tiny),
                                   hn::And(hn::Gt(minor(p.m[0][0], p.m[1][1], p.m[0][1], p.m[0][1]), tinySq),
                                           hn::Gt(determinant(p), hn::Mul(half, det)))));
    // (trace(p) - p)^-1 times the skew part.
    const Double k00 = hn::Add(p.m[1][1], p.m[2][2]);
    const Double k11 = hn::Add(p.m[0][0], p.m[2][2]);
    const Double k22 = hn::Add(p.m[0][0], p.m[1][1]);
    const Double k01 = hn::Neg(p.m[0][1]), k02 = hn::Neg(p.m[0][2]), k12 = hn::Neg(p.m[1][2]);
    const Double i00 = minor(k11, k22, k12, k12);
    const Double i01 = minor(k02, k12, k01, k22);
    const Double i02 = minor(k01, k12, k02, k11);
    const Double i11 = minor(k00, k22, k02, k02);
    const Double i12 = minor(k01, k02, k00, k12);
    const Double i22 = minor(k00, k11, k01, k01);
    const Double share = hn::Div(hn::Set(d, 1.0), dot(k00, i00, k01, i01, k02, i02));
    const Double sx = hn::Mul(share, hn::Sub(a.m[2][1], a.m[1][2]));
    const Double sy = hn::Mul(share, hn::Sub(a.m[0][2], a.m[2][0]));
    const Double sz = hn::Mul(share, hn::Sub(a.m[1][0], a.m[0][1]));
    const Double x = dot(i00, sx, i01, sy, i02, sz);
    const Double y = dot(i01, sx, i11, sy, i12, sz);
    const Double z = dot(i02, sx, i12, sy, i22, sz);
    const Matrix next = product(r, turnBy(x, y, z));
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) r.m[i][j] = hn::IfThenElse(going, next.m[i][j], r.m[i][j]);
    }
    const auto settled = hn::And(going, hn::Le(dot(x, x, y, y, z, z), hn::Set(d, kSettled * kSettled)));
    found = hn::Or(found, settled);
    going = hn::AndNot(settled, going);
  }
  alignas(64) std::uint8_t bits[8] = {};
  hn::StoreMaskBits(d, found, bits);
  return bits[0];
}

std::uint32_t fitBlock(const MatrixBlock& covariances, MatrixBlock& rotations) {
  const Doubles d;
  std::uint32_t found = 0;
  for (std::size_t lane = 0; lane < MatrixBlock::kMatrices; lane += hn::Lanes(d)) {
    Matrix covariance;
    Matrix rotation;
    for (std::size_t e = 0; e < 9; ++e) {
      covariance.m[e / 3][e % 3] = hn::Load(d, covariances.entry[e].data() + lane);
      rotation.m[e / 3][e % 3] = hn::Load(d, rotations.entry[e].data() + lane);
    }
    found |= fitLanes(covariance, rotation) << lane;
    for (std::size_t e = 0; e < 9; ++e) hn::Store(rotation.m[e / 3][e % 3], d, rotations.entry[e].data() + lane);
  }
  return found;
}

}  // namespace lorica::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace lorica {
namespace {
HWY_EXPORT(fitBlock);
}  // namespace

std::uint32_t fitNearby(const MatrixBlock& covariances, MatrixBlock& rotations) {
  return HWY_DYNAMIC_DISPATCH(fitBlock)(covariances, rotations);
}

}  // namespace lorica
#endif
