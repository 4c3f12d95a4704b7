#include "session/scenes/contact_props.h"

#include "geometry/counts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>

namespace lorica {
namespace {

constexpr int kSides = 32;  // of a cylinder

void addCorners(const Prop& prop, std::vector<Vec3>& points) {
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 signs((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
    points.emplace_back(prop.worldFromProp * signs.cwiseProduct(prop.halfExtents));
  }
}

}  // namespace

/// @param hull  index of the piece of a mesh; 0 for other shapes
void PropMeetings::setPiece(const Prop& prop, std::size_t hull) {
  const Vec3& half = prop.halfExtents;
  piece_.points.clear();
  piece_.radius = 0.0;
  switch (prop.shape) {
    case PropShape::kBox:
      addCorners(prop, piece_.points);
      break;
    case PropShape::kSphere:
      piece_.radius = half.x();
      piece_.points.emplace_back(prop.worldFromProp.translation());
      break;
    case PropShape::kCapsule:
      piece_.radius = half.x();
      for (const double end : {-1.0, 1.0}) {
        piece_.points.emplace_back(prop.worldFromProp * Vec3(0.0, end * (half.y() - half.x()), 0.0));
      }
      break;
    case PropShape::kCylinder:
      for (int i = 0; i < kSides; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / kSides;
        const Vec3 rim(half.x() * std::cos(angle), half.y(), half.x() * std::sin(angle));
        piece_.points.emplace_back(prop.worldFromProp * rim);
        piece_.points.emplace_back(prop.worldFromProp * rim.cwiseProduct(Vec3(1.0, -1.0, 1.0)));
      }
      break;
    case PropShape::kMesh:
      for (const Vec3& v : prop.mesh->hulls[hull].vertices) piece_.points.emplace_back(prop.worldFromProp * v);
      break;
  }
  piece_.box = boundsOf(piece_.points);
  piece_.box.min.array() -= piece_.radius;
  piece_.box.max.array() += piece_.radius;
}

/// Measures a prop against the parts of an avatar that are near it.
void PropMeetings::findProp(int index, const Prop& prop, int avatar, ContactOutline& outline) {
  const std::size_t pieces = prop.shape == PropShape::kMesh ? prop.mesh->hulls.size() : 1;
  for (std::size_t hull = 0; hull < pieces; ++hull) {
    setPiece(prop, hull);
    const auto begin = static_cast<std::ptrdiff_t>(found_.size());
    bool deep = false;
    for (std::size_t p = 0; p < outline.parts.size(); ++p) {
      if (outline.parts[p].shape.degenerate()) continue;
      const std::optional<Meeting> meeting =
          measured(outline.pointsOf(p), outline.boxes[p], piece_.points, piece_.box, piece_.radius, reach_);
      if (!meeting) continue;
      deep = deep || meeting->depth == 0.0;
      found_.push_back({avatar, static_cast<int>(p), index, *meeting});
    }
    if (!deep) continue;
    for (const ShapeContact& contact : outline.query.find(outline.parts, {piece_.points, piece_.radius})) {
      const auto found = std::find_if(found_.begin() + begin, found_.end(),
                                      [&](const PropMeeting& one) { return one.part == contact.part; });
      if (found != found_.end()) found->meeting = {contact.depth, contact.position, contact.direction};
    }
  }
}

std::span<const PropMeeting> PropMeetings::find(const Session& session, std::span<ContactOutline> outlines) {
  found_.clear();
  const std::span<const Prop> props = session.world().props();
  for (int index = 0; index < countOf(props); ++index) {
    const Prop& prop = props[index];
    const Vec3 middle = prop.worldFromProp.translation(), extent = Vec3::Constant(boundingRadius(prop));
    const Aabb around{middle - extent, middle + extent};
    for (int a = 0; a < countOf(outlines); ++a) {
      if (outlines[a].box.empty() || apart(outlines[a].box, around, reach_)) continue;
      findProp(index, prop, a, outlines[a]);
    }
  }
  for (const Contact& contact : session.world().contacts()) {
    found_.push_back(
        {contact.avatar, contact.part, contact.prop, {contact.depth, contact.point, contact.normal}, contact.impulse});
  }
  std::ranges::sort(found_, [](const PropMeeting& a, const PropMeeting& b) {
    return std::tuple(a.key(), -a.meeting.depth) < std::tuple(b.key(), -b.meeting.depth);
  });
  std::size_t kept = 0;
  for (const PropMeeting& one : found_) {
    if (kept > 0 && found_[kept - 1].key() == one.key()) {
      found_[kept - 1].impulse += one.impulse;
    } else {
      found_[kept++] = one;
    }
  }
  return std::span(found_).first(kept);
}

}  // namespace lorica
