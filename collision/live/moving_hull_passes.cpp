#include "collision/live/moving_hull_passes.h"

#include "collision/live/moving_hull_exact.h"

#include <array>
#include <numeric>

// Highway compiles the code between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set. Not for
// vectors whose size is known only at run time: such vectors cannot be members of a struct.
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "collision/live/moving_hull_passes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lorica::HWY_NAMESPACE {

// The determinant of the corners, rounded as in the vector version.
HWY_INLINE double determinant(const PointRow* points, const Triangle& face) {
  const PointRow& a = points[face[0]];
  const exact::Row n = exact::cross(exact::between(a, points[face[1]]), exact::between(a, points[face[2]]));
  return n.x * a.x + n.y * a.y + n.z * a.z;
}

#if HWY_TARGET == HWY_SCALAR

// Without vector instructions, everything is decided exactly at once: all faces are in doubt.
int doubtfulFaces(const PointRow*, const Triangle*, const VertexIndex*, int count, std::int32_t* doubts) {
  for (int face = 0; face < count; ++face) doubts[face] = face * kFaceBits + kFaceBits - 1;
  return count;
}

int doubtfulCertificates(const PointRow*, const HullCertificate*, int count, std::int32_t* doubts) {
  for (int i = 0; i < count; ++i) doubts[i] = i;
  return count;
}

double sumDeterminants(const PointRow* points, const Triangle* faces, int count) {
  std::array<double, kPassWidth> sums{};
  for (int face = 0; face < count; ++face) {
    sums[face % kPassWidth] += determinant(points, faces[face]);
  }
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

#else

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, kPassWidth>;
using Float = hn::Vec<Floats>;
using Ints = hn::RebindToSigned<Floats>;
constexpr int kLanes = hn::MaxLanes(Floats());

/// Three coordinates of as many points as there are lanes.
struct Points {
  Float x, y, z;
};

// Block k of the result is the row of point ids[4 * k * stride]. Gather instructions are slower than this.
template <class D>
HWY_INLINE hn::Vec<D> blocksOfRows(D d, const PointRow* points, const std::int32_t* ids, int stride) {
  if constexpr (hn::MaxLanes(d) == 4) {
    return hn::Load(d, &points[*ids].x);
  } else {
    const hn::Half<D> half;
    const auto lower = blocksOfRows(half, points, ids, stride);
    const int lanes = hn::MaxLanes(half);
    return hn::Combine(d, blocksOfRows(half, points, ids + lanes * stride, stride), lower);
  }
}

// Lane i is the point ids[i * stride].
HWY_INLINE Points rowsOf(const PointRow* points, const std::int32_t* ids, int stride) {
  const Floats f;
  const hn::RepartitionToWide<Floats> pairs;
  const auto p0 = blocksOfRows(f, points, ids, stride);
  const auto p1 = blocksOfRows(f, points, ids + stride, stride);
  const auto p2 = blocksOfRows(f, points, ids + 2 * stride, stride);
  const auto p3 = blocksOfRows(f, points, ids + 3 * stride, stride);
  const auto xy01 = hn::BitCast(pairs, hn::InterleaveLower(f, p0, p1));
  const auto xy23 = hn::BitCast(pairs, hn::InterleaveLower(f, p2, p3));
  const auto zw01 = hn::BitCast(pairs, hn::InterleaveUpper(f, p0, p1));
  const auto zw23 = hn::BitCast(pairs, hn::InterleaveUpper(f, p2, p3));
  return {hn::BitCast(f, hn::InterleaveLower(pairs, xy01, xy23)),
          hn::BitCast(f, hn::InterleaveUpper(pairs, xy01, xy23)),
          hn::BitCast(f, hn::InterleaveLower(pairs, zw01, zw23))};
}

HWY_INLINE Points operator-(const Points& a, const Points& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

/// A cross product, and for each coordinate the sum of the absolute values of its two products.
struct Cross {
  Points value;
  Points size;
};

HWY_INLINE Cross cross(const Points& u, const Points& v) {
  const Float yz = hn::Mul(u.y, v.z), zy = hn::Mul(u.z, v.y);
  const Float zx = hn::Mul(u.z, v.x), xz = hn::Mul(u.x, v.z);
  const Float xy = hn::Mul(u.x, v.y), yx = hn::Mul(u.y, v.x);
  return {{hn::Sub(yz, zy), hn::Sub(zx, xz), hn::Sub(xy, yx)},
          {hn::Add(hn::Abs(yz), hn::Abs(zy)), hn::Add(hn::Abs(zx), hn::Abs(xz)), hn::Add(hn::Abs(xy), hn::Abs(yx))}};
}

/// A determinant and a bound on its error.
struct Bounded {
  Float value;
  Float error;
};

// With unit roundoff e = 2^-24 and exact factors u, v, w: products and their difference add up to 2 e of the absolute
// sum to a coordinate of the normal; the product with w and two sums add 3 e more. The e^2 terms and the rounding of
// the absolute sum itself are far below the remaining one e of the 6.
HWY_INLINE Bounded dot(const Cross& n, const Points& w) {
  const Floats f;
  const Float size =
      hn::MulAdd(n.size.x, hn::Abs(w.x), hn::MulAdd(n.size.y, hn::Abs(w.y), hn::Mul(n.size.z, hn::Abs(w.z))));
  return {hn::MulAdd(n.value.x, w.x, hn::MulAdd(n.value.y, w.y, hn::Mul(n.value.z, w.z))),
          hn::Mul(hn::Set(f, 6.0F * 0x1p-24F), size)};
}

HWY_INLINE hn::Mask<Floats> surelyAbove(const Bounded& b) {
  return hn::Gt(b.value, b.error);
}

HWY_INLINE hn::Mask<Floats> surelyBelow(const Bounded& b) {
  return hn::Lt(hn::Add(b.value, b.error), hn::Zero(Floats()));
}

HWY_INLINE hn::Vec<Ints> bitWhereNot(hn::Mask<Floats> sure, std::int32_t bit) {
  const Ints n;
  return hn::IfThenZeroElse(hn::RebindMask(n, sure), hn::Set(n, bit));
}

int doubtfulFaces(const PointRow* points, const Triangle* faces, const VertexIndex* opposites, int count,
                  std::int32_t* doubts) {
  const Ints n;
  int found = 0;
  for (int first = 0; first < count; first += kLanes) {
    const std::int32_t* ids = faces[first].data();
    const Points a = rowsOf(points, ids, 3);
    const Points b = rowsOf(points, ids + 1, 3);
    const Points c = rowsOf(points, ids + 2, 3);
    const Cross normal = cross(b - a, c - a);
    auto doubt = bitWhereNot(surelyAbove(dot(normal, a)), kMayBeTurned);
    // z of a x b and so on: rounding preserves the order of two products.
    const auto pierced =
        hn::And(hn::Ge(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x)),
                hn::And(hn::Ge(hn::Mul(b.x, c.y), hn::Mul(b.y, c.x)), hn::Ge(hn::Mul(c.x, a.y), hn::Mul(c.y, a.x))));
    doubt = hn::Or(doubt, bitWhereNot(hn::Not(pierced), kMayBePierced));
    const std::int32_t* across = opposites + 3 * first;
    for (int edge = 0; edge < 3; ++edge) {
      const Points opposite = rowsOf(points, across + edge, 3);
      doubt = hn::Or(doubt, bitWhereNot(surelyBelow(dot(normal, opposite - a)), kEdgeMayBeConcave << edge));
    }
    if (hn::AllTrue(n, hn::Eq(doubt, hn::Zero(n)))) continue;
    HWY_ALIGN std::int32_t bits[kLanes];
    hn::Store(doubt, n, bits);
    for (int lane = 0; lane < kLanes && first + lane < count; ++lane) {
      doubts[found] = (first + lane) * kFaceBits + bits[lane];
      found += bits[lane] != 0 ? 1 : 0;
    }
  }
  return found;
}

int doubtfulCertificates(const PointRow* points, const HullCertificate* certificates, int count, std::int32_t* doubts) {
  const Floats f;
  int found = 0;
  for (int first = 0; first < count; first += kLanes) {
    const std::int32_t* ids = &certificates[first].a;
    const Points a = rowsOf(points, ids, 4);
    const Points b = rowsOf(points, ids + 1, 4);
    const Points c = rowsOf(points, ids + 2, 4);
    const Points p = rowsOf(points, ids + 3, 4);
    // Within the cone of a, b, c, by det(a, b, p), det(c, a, p) and det(b, c, p), and below their plane.
    const Cross pa = cross(p, a);
    const auto beside = hn::And(surelyAbove(dot(pa, b)), surelyBelow(dot(pa, c)));
    const auto inside = hn::And(surelyAbove(dot(cross(b, c), p)), surelyBelow(dot(cross(b - a, c - a), p - a)));
    const auto sure = hn::And(beside, inside);
    if (hn::AllTrue(f, sure)) continue;
    HWY_ALIGN std::uint8_t bits[8] = {};
    hn::StoreMaskBits(f, sure, bits);
    const int held = bits[0] | bits[1] << 8;
    for (int lane = 0; lane < kLanes && first + lane < count; ++lane) {
      doubts[found] = first + lane;
      found += 1 - (held >> lane & 1);
    }
  }
  return found;
}

// Lane sums over faces whose numbers are equal modulo kPassWidth, for any vector width.
HWY_INLINE void addDeterminants(const Points& a, const Points& ab, const Points& ac, bool upper, double* sums) {
  const hn::Rebind<double, hn::Half<Floats> > d;
  const hn::Half<Floats> h;
  const auto wide = [&](Float v)
                        HWY_ATTR { return hn::PromoteTo(d, upper ? hn::UpperHalf(h, v) : hn::LowerHalf(h, v)); };
  const auto ux = wide(ab.x), uy = wide(ab.y), uz = wide(ab.z);
  const auto vx = wide(ac.x), vy = wide(ac.y), vz = wide(ac.z);
  const auto nx = hn::Sub(hn::Mul(uy, vz), hn::Mul(uz, vy));
  const auto ny = hn::Sub(hn::Mul(uz, vx), hn::Mul(ux, vz));
  const auto nz = hn::Sub(hn::Mul(ux, vy), hn::Mul(uy, vx));
  const auto det = hn::Add(hn::Add(hn::Mul(nx, wide(a.x)), hn::Mul(ny, wide(a.y))), hn::Mul(nz, wide(a.z)));
  double* here = sums + (upper ? kLanes / 2 : 0);
  hn::StoreU(hn::Add(hn::LoadU(d, here), det), d, here);
}

double sumDeterminants(const PointRow* points, const Triangle* faces, int count) {
  HWY_ALIGN std::array<double, kPassWidth> sums{};
  int first = 0;
  for (; first + kLanes <= count; first += kLanes) {
    const std::int32_t* ids = faces[first].data();
    const Points a = rowsOf(points, ids, 3);
    const Points b = rowsOf(points, ids + 1, 3);
    const Points c = rowsOf(points, ids + 2, 3);
    double* here = sums.data() + first % kPassWidth;
    addDeterminants(a, b - a, c - a, false, here);
    addDeterminants(a, b - a, c - a, true, here);
  }
  for (; first < count; ++first) sums[first % kPassWidth] += determinant(points, faces[first]);
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

#endif  // HWY_TARGET == HWY_SCALAR

}  // namespace lorica::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace lorica {
namespace {

HWY_EXPORT(doubtfulFaces);
HWY_EXPORT(doubtfulCertificates);
HWY_EXPORT(sumDeterminants);

}  // namespace

int findDoubtfulFaces(const PointRow* points, const Triangle* faces, const VertexIndex* opposites, int count,
                      std::int32_t* doubts) {
  return HWY_DYNAMIC_DISPATCH(doubtfulFaces)(points, faces, opposites, count, doubts);
}

int findDoubtfulCertificates(const PointRow* points, const HullCertificate* certificates, int count,
                             std::int32_t* doubts) {
  return HWY_DYNAMIC_DISPATCH(doubtfulCertificates)(points, certificates, count, doubts);
}

double sumOfDeterminants(const PointRow* points, const Triangle* faces, int count) {
  return HWY_DYNAMIC_DISPATCH(sumDeterminants)(points, faces, count);
}

}  // namespace lorica
#endif
