#include "bindings/c/guard.h"
#include "bindings/c/handles.h"
#include "bindings/live_contacts.h"

using namespace lorica;

struct FoundContacts {
  LiveContacts ask;
  std::uint64_t pose = 0;  ///< in which the rest was found
  std::vector<SelfContact> contacts;
  std::vector<ShapeContact> touches;
  std::vector<Vec3> points;  ///< scratch
};

namespace {

/// Whether anything was looked for in the present pose.
bool isFound(const lorica_live& live) {
  return live.found != nullptr && live.found->pose == live.live.poses();
}

/// Without what was found in another pose.
FoundContacts& foundIn(lorica_live& live) {
  if (live.found == nullptr) live.found = std::make_shared<FoundContacts>();
  if (!isFound(live)) {
    live.found->contacts.clear();
    live.found->touches.clear();
  }
  live.found->pose = live.live.poses();
  return *live.found;
}

}  // namespace

lorica_status lorica_live_find_contacts(lorica_live* live, size_t* count) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(live, "live", count, "count"));
    FoundContacts& found = foundIn(*live);
    const std::span<const SelfContact> now = found.ask.ofItself(live->live);
    found.contacts.assign(now.begin(), now.end());
    *count = found.contacts.size();
    return {};
  });
}

lorica_status lorica_live_contact(const lorica_live* live, size_t index, lorica_contact* out) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(live, "live"));
    LORICA_TRY_DO(inRange(index, isFound(*live) ? live->found->contacts.size() : 0, "contact"));
    const SelfContact& found = live->found->contacts[index];
    lorica_contact contact = {};
    contact.first = found.first;
    contact.second = found.second;
    Eigen::Map<Vec3>(contact.position) = found.position;
    Eigen::Map<Vec3>(contact.direction) = found.direction;
    contact.depth = found.depth;
    return handOut(contact, out);
  });
}

lorica_status lorica_live_find_touches(lorica_live* live, const lorica_shape* shape, size_t* count) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(live, "live", shape, "shape", count, "count"));
    LORICA_TRY(const lorica_shape whole, taken(shape, "shape"));
    LORICA_TRY_DO(given(whole.points, "shape.points"));
    FoundContacts& found = foundIn(*live);
    found.points.clear();
    for (std::size_t i = 0; i < whole.point_count; ++i) found.points.emplace_back(whole.points + 3 * i);
    const RoundedShape rounded{found.points, whole.radius};
    LORICA_TRY_DO(checkShape(rounded));
    const std::span<const ShapeContact> now = found.ask.withShape(live->live, rounded);
    found.touches.assign(now.begin(), now.end());
    *count = found.touches.size();
    return {};
  });
}

lorica_status lorica_live_touch(const lorica_live* live, size_t index, lorica_touch* out) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(live, "live"));
    LORICA_TRY_DO(inRange(index, isFound(*live) ? live->found->touches.size() : 0, "touch"));
    const ShapeContact& found = live->found->touches[index];
    lorica_touch touch = {};
    touch.part = found.part;
    Eigen::Map<Vec3>(touch.position) = found.position;
    Eigen::Map<Vec3>(touch.direction) = found.direction;
    touch.depth = found.depth;
    return handOut(touch, out);
  });
}
