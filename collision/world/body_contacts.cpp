#include "collision/world/body_contacts.h"

#include "collision/live/extent_kernel.h"
#include "collision/world/part_overlap.h"
#include "collision/world/part_shape.h"
#include "collision/world/strike_limit.h"
#include "geometry/result.h"
#include "geometry/threads.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

namespace lorica {
namespace {

/// A part of the present frame.
struct Solid {
  PartShape shape{0.0f};
  Aabb bounds;              ///< world [m]; empty while the part is flat
  bool needsShape = false;  ///< whether it is in a pair; then `shape` is of this frame
};

/// A body of the present frame.
struct Outline {
  std::vector<Solid> solids;
  Aabb bounds;  ///< of all solids
};

}  // namespace

struct BodyContactQuery::Impl {
  std::vector<Outline> bodies;
  std::vector<std::pair<double, int>> order;  ///< bodies by the least x
  std::vector<std::pair<int, int>> meeting;   ///< bodies whose boxes overlap, ascending
  std::vector<PartIndex> near;                ///< scratch: parts of a second body
  std::vector<BodyContact> pairs;             ///< of parts that are examined; with depth if they overlap
  std::vector<BodyContact> contacts;
  bool tooMany = false;

  void readBounds(std::span<const BodyInWorld> present);
  void findMeeting();
  void findPairs(std::span<const BodyInWorld> present, int a, int b);
  void makeShapes(std::span<const BodyInWorld> present);
  void test(const BodyInWorld& first, const BodyInWorld& second, BodyContact& contact, double seconds) const;
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
  impl_->pairs.clear();
  impl_->tooMany = false;
  impl_->readBounds(bodies);
  impl_->findMeeting();
  for (const auto& [a, b] : impl_->meeting) impl_->findPairs(bodies, a, b);
  impl_->makeShapes(bodies);
  parallelFor(impl_->pairs.size(), [&](std::size_t i) {
    BodyContact& pair = impl_->pairs[i];
    impl_->test(bodies[pair.firstBody], bodies[pair.secondBody], pair, seconds);
  });
  std::copy_if(impl_->pairs.begin(), impl_->pairs.end(), std::back_inserter(impl_->contacts),
               [](const BodyContact& pair) { return pair.depth > 0.0; });
  return impl_->contacts;
}

void BodyContactQuery::Impl::readBounds(std::span<const BodyInWorld> present) {
  if (bodies.size() < present.size()) bodies.resize(present.size());
  parallelFor(present.size(), [&](std::size_t b) {
    const std::span<const LivePart> parts = present[b].parts;
    LORICA_CHECK(parts.size() == present[b].masses.size(), "each part has a mass");
    Outline& body = bodies[b];
    if (body.solids.size() < parts.size()) body.solids.resize(parts.size());
    body.bounds = Aabb();
    for (std::size_t p = 0; p < parts.size(); ++p) {
      if (p + 1 < parts.size()) fetch(parts[p + 1].shape.vertices);
      Solid& solid = body.solids[p];
      solid.needsShape = false;
      solid.bounds = Aabb();
      if (parts[p].shape.degenerate()) continue;
      solid.bounds = boundsOf(parts[p].shape.vertices, parts[p].worldFromPart);
      body.bounds.extend(solid.bounds.min);
      body.bounds.extend(solid.bounds.max);
    }
  });
  order.clear();
  for (std::size_t b = 0; b < present.size(); ++b) {
    if (!bodies[b].bounds.empty()) order.emplace_back(bodies[b].bounds.min.x(), static_cast<int>(b));
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

void BodyContactQuery::Impl::findPairs(std::span<const BodyInWorld> present, int a, int b) {
  Outline& first = bodies[a];
  Outline& second = bodies[b];
  near.clear();
  for (std::size_t p = 0; p < present[b].parts.size(); ++p) {
    if (!second.solids[p].bounds.empty() && !apart(first.bounds, second.solids[p].bounds)) {
      near.push_back(p);
    }
  }
  for (std::size_t p = 0; p < present[a].parts.size(); ++p) {
    const Aabb& bounds = first.solids[p].bounds;
    if (bounds.empty() || apart(bounds, second.bounds)) continue;
    for (const PartIndex other : near) {
      if (apart(bounds, second.solids[other].bounds)) continue;
      if (pairs.size() == kMaxPairs) {
        tooMany = true;
        return;
      }
      first.solids[p].needsShape = second.solids[other].needsShape = true;
      BodyContact& contact = pairs.emplace_back();
      contact.firstBody = a;
      contact.secondBody = b;
      contact.firstPart = p;
      contact.secondPart = other;
    }
  }
}

void BodyContactQuery::Impl::makeShapes(std::span<const BodyInWorld> present) {
  parallelFor(present.size(), [&](std::size_t b) {
    for (std::size_t p = 0; p < present[b].parts.size(); ++p) {
      Solid& solid = bodies[b].solids[p];
      if (solid.needsShape) solid.shape.setPoints(present[b].parts[p].shape.vertices);
    }
  });
}

/// @param contact  with its bodies and parts; the rest is filled in if they overlap
void BodyContactQuery::Impl::test(const BodyInWorld& first, const BodyInWorld& second, BodyContact& contact,
                                  double seconds) const {
  const LivePart& firstPart = first.parts[contact.firstPart];
  const LivePart& secondPart = second.parts[contact.secondPart];
  const PartShape& firstShape = bodies[contact.firstBody].solids[contact.firstPart].shape;
  const PartShape& secondShape = bodies[contact.secondBody].solids[contact.secondPart].shape;
  const std::optional<PartOverlap> overlap = overlapOf(firstPart, firstShape, secondPart, secondShape);
  if (!overlap) return;
  contact.position = overlap->position;
  contact.direction = overlap->direction;
  contact.depth = overlap->depth;
  contact.relativeVelocity =
      velocityAt(secondPart, contact.position, seconds) - velocityAt(firstPart, contact.position, seconds);
  const double mass = std::min(first.masses[contact.firstPart], second.masses[contact.secondPart]);
  contact.strength = mass * closingSpeed(firstPart, secondPart, contact.position, contact.direction, seconds);
}

}  // namespace lorica
