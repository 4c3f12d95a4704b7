#include "bench/skin_contacts.h"

#include "geometry/counts.h"
#include "geometry/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace lorica::bench {
namespace {

constexpr double kAlike = 1e-6;  // [m]; rows are in single precision

/// A part's skin in one frame. Trees are made when they are needed.
class Skin {
 public:
  Skin(const Session& session, PartIndex part)
      : points_(session.points()),
        part_(session.body().decomposition().parts[part]),
        live_(session.body().parts()[part]) {
    for (std::size_t t = 0; t < part_.triangles.size(); ++t) {
      if (part_.sourceTriangle[t] < 0) continue;  // a cap
      surface_.push_back(part_.triangles[t]);
      for (const VertexIndex v : part_.triangles[t]) corners_.push_back(v);
    }
    std::ranges::sort(corners_);
    corners_.erase(std::unique(corners_.begin(), corners_.end()), corners_.end());
    for (const VertexIndex v : corners_) box_.extend(points_[v]);
  }

  [[nodiscard]] const Aabb& box() const { return box_; }
  [[nodiscard]] bool bare() const { return surface_.empty(); }
  [[nodiscard]] double distance(const Vec3& p) const {
    if (!tree_) tree_ = std::make_unique<TriangleTree>(points_, surface_);
    return tree_->distance(p);
  }
  /// Above 0 outside.
  [[nodiscard]] double signedDistance(const Vec3& p) const {
    if (!closed_) closed_ = std::make_unique<TriangleTree>(points_, part_.triangles);
    return closed_->windingNumber(p) > 0.5 ? -distance(p) : distance(p);
  }
  /// Least signed distance of its corners from another's skin.
  [[nodiscard]] double above(const Skin& other) const {
    double least = kInfinity;
    for (const VertexIndex v : corners_) {
      if (least > 0.0 && distanceSqToBox(points_[v], other.box_) >= least * least) continue;
      least = std::min(least, other.signedDistance(points_[v]));
    }
    return least;
  }
  /// Largest distance of its hull from the skin, looked at in all corners, edges and faces.
  [[nodiscard]] double standOff() const {
    if (standOff_ >= 0.0) return standOff_;
    const std::vector<Vec3>& v = live_.shape.vertices;
    for (const Triangle& t : live_.shape.triangles) {
      for (int i = 0; i < 3; ++i) look(0.5 * (v[t[i]] + v[t[(i + 1) % 3]]));
      look((v[t[0]] + v[t[1]] + v[t[2]]) / 3.0);
    }
    return standOff_;
  }

 private:
  void look(const Vec3& inPart) const { standOff_ = std::max(standOff_, distance(live_.worldFromPart * inPart)); }

  std::span<const Vec3> points_;
  const Part& part_;
  const LivePart& live_;
  std::vector<Triangle> surface_;
  std::vector<VertexIndex> corners_;
  Aabb box_;
  mutable std::unique_ptr<TriangleTree> tree_, closed_;
  mutable double standOff_ = -1.0;
};

/// One pair: what the table says, and the skins' distance.
void add(const ContactRow* row, double skins, double standOff, SkinComparison& sum) {
  const bool overlaps = row != nullptr && row->depth > 0.0F;
  if (skins < -kDeep) {
    ++sum.deep;
    if (!overlaps) ++sum.missed;
  }
  if (row == nullptr) return;
  if (!overlaps) {
    sum.gapError = std::max(sum.gapError, -static_cast<double>(row->depth) - std::max(skins, 0.0) - kAlike);
    return;
  }
  sum.apart.push_back(std::max(skins, 0.0));
  sum.standOff.push_back(standOff);
  sum.beyond = std::max(sum.beyond, skins - standOff);
}

}  // namespace

void compareWithSkin(const Session& session, std::span<const ContactRow> rows, SkinComparison& sum) {
  ++sum.frames;
  sum.rows += std::ssize(rows);
  std::vector<Skin> skins;
  const int count = countOf(session.body().parts());
  for (int p = 0; p < count; ++p) skins.emplace_back(session, p);
  const auto rowOf = [&](ContactKind kind, int part, int other) -> const ContactRow* {
    const ContactRow* deepest = nullptr;  // on the floor a part may have several
    for (const ContactRow& row : rows) {
      const int its = kind == ContactKind::kProp ? row.prop : row.otherPart;
      if (row.kind != kind || row.part != part || (kind != ContactKind::kFloor && its != other)) continue;
      if (deepest == nullptr || row.depth > deepest->depth) deepest = &row;
    }
    return deepest;
  };
  for (int p = 0; p < count; ++p) {
    if (skins[p].bare()) continue;
    const double low = skins[p].box().min.y();
    const ContactRow* floor = rowOf(ContactKind::kFloor, p, -1);
    sum.floors += floor != nullptr && floor->depth > 0.0F ? 1 : 0;
    sum.deep += low < -kDeep ? 1 : 0;
    sum.missed += low < -kDeep && (floor == nullptr || floor->depth <= 0.0F) ? 1 : 0;
    if (floor != nullptr) sum.floorError = std::max(sum.floorError, std::abs(floor->depth + low));
    const std::span<const Prop> props = session.world().props();
    for (int b = 0; b < countOf(props); ++b) {
      const ContactRow* row = rowOf(ContactKind::kProp, p, b);
      const double gap = skins[p].distance(props[b].worldFromProp.translation()) - props[b].halfExtents.x();
      if (row == nullptr && gap > -kDeep) continue;
      sum.props += row != nullptr && row->depth > 0.0F ? 1 : 0;
      add(row, gap, skins[p].standOff(), sum);
    }
    for (int q = p + 1; q < count; ++q) {
      if (skins[q].bare() || session.avatar().areNeighbours(p, q)) continue;
      const ContactRow* row = rowOf(ContactKind::kSelf, p, q);
      const Aabb &a = skins[p].box(), &b = skins[q].box();
      const bool apart = (a.min.array() > b.max.array()).any() || (b.min.array() > a.max.array()).any();
      if (row == nullptr && apart) continue;
      sum.pairs += row != nullptr && row->depth > 0.0F ? 1 : 0;
      const double gap = std::min(skins[p].above(skins[q]), skins[q].above(skins[p]));
      add(row, gap, skins[p].standOff() + skins[q].standOff(), sum);
    }
  }
}

World fixedBalls() {
  World world;
  for (const auto& [x, y, z, radius] : {std::array{0.4, 1.0, 0.25, 0.15}, std::array{-0.4, 0.9, 0.3, 0.15},
                                        std::array{0.0, 0.5, 0.4, 0.2}, std::array{0.2, 0.05, 0.15, 0.12}}) {
    Prop ball;
    ball.shape = PropShape::kSphere;
    ball.halfExtents = Vec3::Constant(radius);
    ball.mass = 0.0;
    ball.worldFromProp.translation() = Vec3(x, y, z);
    world.addProp(ball);
  }
  return world;
}

}  // namespace lorica::bench
