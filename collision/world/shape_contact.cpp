#include "collision/world/shape_contact.h"

#include "collision/live/extent_kernel.h"
#include "collision/world/part_overlap.h"
#include "geometry/result.h"

#include <algorithm>
#include <optional>
#include <vector>

namespace lorica {
namespace {

Aabb boundsOf(const LivePart& part) {
  Aabb bounds;
  for (const Vec3& v : part.shape.vertices) bounds.extend(part.worldFromPart * v);
  return bounds;
}

}  // namespace

struct ShapeContactQuery::Impl {
  PartShape partShape{0.0F}, givenShape{0.0F};
  LivePart given;  ///< the shape's points about their middle
  std::vector<ShapeContact> contacts;
};

ShapeContactQuery::ShapeContactQuery(const LiveBody& body) : impl_(std::make_unique<Impl>()) {
  std::size_t most = 0;
  for (std::size_t p = 0; p < body.parts().size(); ++p) {
    most = std::max(most, body.candidateCount(p));
  }
  impl_->partShape.reserve(most);
  impl_->contacts.reserve(body.parts().size());
}

ShapeContactQuery::~ShapeContactQuery() = default;
ShapeContactQuery::ShapeContactQuery(ShapeContactQuery&&) noexcept = default;
ShapeContactQuery& ShapeContactQuery::operator=(ShapeContactQuery&&) noexcept = default;

std::span<const ShapeContact> ShapeContactQuery::find(std::span<const LivePart> parts, const RoundedShape& shape) {
  LORICA_CHECK(!shape.points.empty() && shape.radius >= 0.0, "a shape has points, and no radius below 0");
  Aabb bounds;
  for (const Vec3& p : shape.points) bounds.extend(p);
  LivePart& given = impl_->given;
  given.worldFromPart.translation() = bounds.center();
  given.shape.vertices.clear();
  for (const Vec3& p : shape.points) given.shape.vertices.emplace_back(p - bounds.center());
  impl_->givenShape.setPoints(given.shape.vertices);

  impl_->contacts.clear();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].shape.degenerate() || apart(boundsOf(parts[i]), bounds, shape.radius)) continue;
    impl_->partShape.setPoints(parts[i].shape.vertices);
    const std::optional<PartOverlap> overlap =
        overlapOf(parts[i], impl_->partShape, given, impl_->givenShape, shape.radius);
    if (!overlap) continue;
    impl_->contacts.push_back({static_cast<PartIndex>(i), overlap->position, overlap->direction, overlap->depth});
  }
  return impl_->contacts;
}

}  // namespace lorica
