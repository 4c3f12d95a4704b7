#include "bindings/live_contacts.h"

#include "geometry/errors.h"

namespace lorica {

std::span<const SelfContact> LiveContacts::ofItself(const LiveCharacter& live) {
  if (!live.posed()) return {};
  if (!self_) self_.emplace(live.liveBody(), live.body().character().mesh.vertices);
  return self_->find(live.parts());
}

std::span<const ShapeContact> LiveContacts::withShape(const LiveCharacter& live, const RoundedShape& shape) {
  if (!live.posed()) return {};
  if (!shape_) shape_.emplace(live.liveBody());
  return shape_->find(live.parts(), shape);
}

Result<void> checkShape(const RoundedShape& shape) {
  constexpr double kFarthest = 1e6;  // [m]; single precision has nothing to say beyond
  if (shape.points.empty()) return invalidArgument("points: found none, expected at least one");
  if (!(shape.radius >= 0.0 && shape.radius <= kFarthest)) {
    return invalidArgument("radius: found {}, expected 0 to 1,000,000 m", shape.radius);
  }
  for (std::size_t i = 0; i < shape.points.size(); ++i) {
    const Vec3& p = shape.points[i];
    if (p.allFinite() && p.cwiseAbs().maxCoeff() <= kFarthest) continue;
    return invalidArgument("point {}: found {} {} {}, expected -1,000,000 to 1,000,000 m", i, p.x(), p.y(), p.z());
  }
  return {};
}

}  // namespace lorica
