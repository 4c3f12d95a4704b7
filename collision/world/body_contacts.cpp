#include "collision/world/body_contacts.h"

#include "collision/world/part_overlap.h"
#include "collision/world/part_shape.h"
#include "collision/world/strike_limit.h"
#include "geometry/result.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

namespace lorica {
namespace {

/// A part of the present frame.
struct Solid {
  PartShape shape{0.0f};
  Aabb bounds;            ///< world [m]; empty while the part is flat
  bool hasShape = false;  ///< whether `shape` is of this frame
};

/// A body of the present frame.
struct Outline {
  std::vector<Solid> solids;
  Aabb bounds;  ///< of all solids
};

bool apart(const Aabb& a, const Aabb& b) {
  return (a.min.array() > b.max.array()).any() || (b.min.array() > a.max.array()).any();
}

}  // namespace

struct BodyContactQuery::Impl {
  std::vector<Outline> bodies;
  std::vector<std::pair<double, int>> order;  ///< bodies by the least x
  std::vector<std::pair<int, int>> meeting;   ///< bodies whose boxes overlap, ascending
  std::vector<PartIndex> near;                ///< scratch: parts of a second body
  std::vector<BodyContact> contacts;
  std::size_t pairs = 0;  ///< that were examined
  bool tooMany = false;

  void readBounds(std::span<const BodyInWorld> present);
  void findMeeting();
  void meet(std::span<const BodyInWorld> present, int a, int b, double seconds);
  void test(const BodyInWorld& first, const BodyInWorld& second, BodyContact contact, double seconds);
  const PartShape& shapeOf(const BodyInWorld& body, int index, PartIndex part);
};

BodyContactQuery::BodyContactQuery() : impl_(std::make_unique<Impl>()) {}
BodyContactQuery::~BodyContactQuery() = default;
BodyContactQuery::BodyContactQuery(BodyContactQuery&&) noexcept = default;
BodyContactQuery& BodyContactQuery::operator=(BodyContactQuery&&) noexcept = default;

bool BodyContactQuery::tooMany() const {
  return impl_->tooMany;
}

std::span<const BodyContact> BodyContactQuery::find(std::span<const BodyInWorld> bodies, double seconds) {
  impl_->contacts.clear();
  impl_->pairs = 0;
  impl_->tooMany = false;
  impl_->readBounds(bodies);
  impl_->findMeeting();
  for (const auto& [a, b] : impl_->meeting) impl_->meet(bodies, a, b, seconds);
  return impl_->contacts;
}

void BodyContactQuery::Impl::readBounds(std::span<const BodyInWorld> present) {
  if (bodies.size() < present.size()) bodies.resize(present.size());
  order.clear();
  for (std::size_t b = 0; b < present.size(); ++b) {
    const std::span<const LivePart> parts = present[b].parts;
    LORICA_CHECK(parts.size() == present[b].masses.size(), "each part has a mass");
    Outline& body = bodies[b];
    if (body.solids.size() < parts.size()) body.solids.resize(parts.size());
    body.bounds = Aabb();
    for (std::size_t p = 0; p < parts.size(); ++p) {
      Solid& solid = body.solids[p];
      solid.hasShape = false;
      solid.bounds = Aabb();
      if (parts[p].shape.degenerate()) continue;
      for (const Vec3& v : parts[p].shape.vertices) solid.bounds.extend(parts[p].worldFromPart * v);
      body.bounds.extend(solid.bounds.min);
      body.bounds.extend(solid.bounds.max);
    }
    if (!body.bounds.empty()) order.emplace_back(body.bounds.min.x(), static_cast<int>(b));
  }
}

void BodyContactQuery::Impl::findMeeting() {
  meeting.clear();
  std::sort(order.begin(), order.end());
  for (auto i = order.begin(); i != order.end(); ++i) {
    const Aabb& bounds = bodies[i->second].bounds;
    for (auto j = i + 1; j != order.end() && j->first <= bounds.max.x(); ++j) {
      if (apart(bounds, bodies[j->second].bounds)) continue;
      if (meeting.size() == kMaxPairs) {
        tooMany = true;
        return;
      }
      meeting.emplace_back(std::minmax(i->second, j->second));
    }
  }
  std::sort(meeting.begin(), meeting.end());
}

void BodyContactQuery::Impl::meet(std::span<const BodyInWorld> present, int a, int b, double seconds) {
  const Outline& first = bodies[a];
  const Outline& second = bodies[b];
  near.clear();
  for (std::size_t p = 0; p < present[b].parts.size(); ++p) {
    if (!second.solids[p].bounds.empty() && !apart(first.bounds, second.solids[p].bounds)) {
      near.push_back(static_cast<PartIndex>(p));
    }
  }
  for (std::size_t p = 0; p < present[a].parts.size(); ++p) {
    const Aabb& bounds = first.solids[p].bounds;
    if (bounds.empty() || apart(bounds, second.bounds)) continue;
    for (const PartIndex other : near) {
      if (apart(bounds, second.solids[other].bounds)) continue;
      if (pairs == kMaxPairs) {
        tooMany = true;
        return;
      }
      ++pairs;
      BodyContact contact;
      contact.firstBody = a;
      contact.secondBody = b;
      contact.firstPart = static_cast<PartIndex>(p);
      contact.secondPart = other;
      test(present[a], present[b], contact, seconds);
    }
  }
}

/// @param contact  with its bodies and parts
void BodyContactQuery::Impl::test(const BodyInWorld& first, const BodyInWorld& second, BodyContact contact,
                                  double seconds) {
  const LivePart& firstPart = first.parts[contact.firstPart];
  const LivePart& secondPart = second.parts[contact.secondPart];
  const PartShape& firstShape = shapeOf(first, contact.firstBody, contact.firstPart);
  const PartShape& secondShape = shapeOf(second, contact.secondBody, contact.secondPart);
  const std::optional<PartOverlap> overlap = overlapOf(firstPart, firstShape, secondPart, secondShape);
  if (!overlap) return;
  contact.position = overlap->position;
  contact.direction = overlap->direction;
  contact.depth = overlap->depth;
  contact.relativeVelocity =
      velocityAt(secondPart, contact.position, seconds) - velocityAt(firstPart, contact.position, seconds);
  const double mass = std::min(first.masses[contact.firstPart], second.masses[contact.secondPart]);
  contact.strength = mass * closingSpeed(firstPart, secondPart, contact.position, contact.direction, seconds);
  contacts.push_back(contact);
}

const PartShape& BodyContactQuery::Impl::shapeOf(const BodyInWorld& body, int index, PartIndex part) {
  Solid& solid = bodies[index].solids[part];
  if (!std::exchange(solid.hasShape, true)) solid.shape.setPoints(body.parts[part].shape.vertices);
  return solid.shape;
}

}  // namespace lorica
