#include "capture/tracking/person_owners.h"

#include "capture/tracking/person_gates.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace lorica {

namespace {

constexpr float kReach = 0.9F;        // max distance from the middle of a person to that of any piece, horizontally [m]
constexpr float kGapNew = 0.35F;      // between pieces of a person in front of known background [m]
constexpr float kGapUnknown = 0.25F;  // and in front of unknown background [m]
constexpr float kHeadsApart = 0.3F;   // between two people's heads, horizontally [m]
constexpr float kNeighbour = 0.4F;    // a head this near to a person's middle is that person's [m]
constexpr float kGrown = 0.42F;      // how far aside a person found at a head reaches from the head's axis at first [m]
constexpr float kGrownBack = 0.4F;   // and how far behind the face [m]
constexpr float kGrownFront = 0.7F;  // and in front of it [m]
constexpr float kGrownStep = 0.02F;  // depth steps larger than this share of the depth end a person found at a head
constexpr float kMinGrown = 0.12F;   // least area of a person found at a head [m^2]
constexpr float kMinTall = 0.4F;     // and least height [m]
constexpr float kHeadDepth = 0.1F;   // from the face to the axis of the head [m]
constexpr double kRefused = 5.0;     // how long no head is looked for where none was [s]
constexpr int kGapCells = 10;        // max gap that noise and shadows may cause between pieces

// Owners of surfaces that are not slots.
constexpr int kNobody = -1;
constexpr int kMaybe = -2;    // a person for whom no slot is free
constexpr int kSeveral = -3;  // already shared between people
constexpr int kScenery = -4;  // continues into the background

Vec3f expected(const PeopleScene& scene, const PersonSlot& slot) {
  return slot.middle + static_cast<float>(scene.elapsed) * slot.velocity;
}

/// Distance along the floor from the middle of a surface to the expected middle of a person [m].
float awayFrom(const PeopleScene& scene, const DepthComponent& one, const PersonSlot& slot) {
  const Vec3f apart = one.middle() - expected(scene, slot);
  return std::hypot(apart.x(), apart.z());
}

int freeSlot(const PersonSlots& slots) {
  for (int k = 0; k < kPersonSlots; ++k) {
    if (!slots[k].used) return k;
  }
  return -1;
}

float horizontally(const Vec3f& v) {
  return std::hypot(v.x(), v.z());
}

/// The middle of a head, behind its surface.
Vec3f axisOf(const PeopleScene& scene, const FoundHead& head) {
  Vec3f away = head.position - scene.floorFromCamera.translation().cast<float>();
  away.y() = 0.0F;
  return head.position + kHeadDepth * away.normalized();
}

/// Whether a surface shows a head that none of some people may have: it is the visible part of another person.
template <typename Mine>
bool hasOtherHead(const PeopleScene& scene, std::size_t component, const Mine& mine) {
  const DepthComponent& one = scene.surfaces.components()[component];
  if (one.area < kMinGrown || one.max.y() - one.min.y() < kMinTall) return false;
  const std::span<const std::int32_t> label = scene.surfaces.labels();
  return std::ranges::any_of(scene.heads, [&](const FoundHead& head) {
    return label[scene.grid.index(head.column, head.row)] == static_cast<std::int32_t>(component) &&
           !mine(axisOf(scene, head));
  });
}

/// Whether a head may be that of a person who is followed.
bool mayBeHeadOf(const PeopleScene& scene, const PersonSlot& slot, const Vec3f& axis) {
  return slot.used && horizontally(axis - expected(scene, slot)) < kHeadsApart;
}

PersonSlot newcomer(const PeopleScene& scene, const Vec3f& middle) {
  PersonSlot slot;
  slot.used = true;
  slot.born = slot.lastSeen = scene.time;
  slot.middle = middle;
  return slot;
}

int rememberedSlot(const PeopleScene& scene, const PersonSlots& slots, const DepthComponent& one) {
  int best = -1;
  float bestDistance = 0.0F;
  for (int k = 0; k < kPersonSlots; ++k) {
    const PersonSlot& slot = slots[k];
    if (!slot.used || slot.seen) continue;
    const auto away = static_cast<float>(scene.time - slot.lastSeen);
    const Vec3f apart = one.middle() - slot.middle;
    const float distance = std::hypot(apart.x(), apart.z());
    if (distance > std::min(0.6F + 1.5F * away, 1.8F) || (best >= 0 && distance >= bestDistance)) continue;
    best = k;
    bestDistance = distance;
  }
  return best;
}

}  // namespace

PersonOwners::PersonOwners(const DepthGrid& grid, const DepthCamera& camera)
    : camera_(camera), split_(grid), person_(grid.cellCount()) {
  owner_.reserve(2048);
  uncovered_.reserve(grid.cellCount());
  region_.reserve(grid.cellCount());
  nobody_.resize(grid.cellCount());
  waiting_.reserve(16);
  stillWaiting_.reserve(16);
}

bool PersonOwners::mayBeSomeone(std::size_t component) const {
  return owner_[component] == kMaybe;
}

void PersonOwners::share(const PeopleScene& scene, PersonSlots& slots) {
  for (PersonSlot& slot : slots) slot.seen = false;
  assign(scene, slots);
  giveBirth(scene, slots);
  giveBirthAtHeads(scene, slots);
  joinPieces(scene, slots);
}

void PersonOwners::refuse(const Vec3f& middle, double time) {
  refusals_[nextRefusal_] = {middle, time + kRefused};
  nextRefusal_ = (nextRefusal_ + 1) % refusals_.size();
}

void PersonOwners::give(const PeopleScene& scene, std::size_t component, int slot, PersonSlots& slots) {
  const DepthComponent& one = scene.surfaces.components()[component];
  owner_[component] = slot;
  slots[slot].seen = true;
  const std::span<const std::int32_t> label = scene.surfaces.labels();
  const bool whole = !isOversize(one) && !slots[slot].attached;
  const Vec3f middle = expected(scene, slots[slot]);
  for (int r = one.top; r <= one.bottom; ++r) {
    for (int c = one.left; c <= one.right; ++c) {
      const std::size_t i = scene.grid.index(c, r);
      if (label[i] != static_cast<std::int32_t>(component)) continue;
      if (!whole) {
        // Merged with something large: the part near the person and in front of known background is the person's.
        const Vec3f apart = scene.positions(scene.grid, c, r) - middle;
        const bool before = scene.last.person[i] != 0 && std::abs(scene.grid.depthMm[i] - scene.last.depthMm[i]) < 150;
        const bool came =
            scene.last.depthMm[i] != 0 && static_cast<float>(scene.last.depthMm[i] - scene.grid.depthMm[i]) >
                                              1000.0F * scene.surfaces.step(scene.grid.depthMm[i]);
        const bool mine = before || came || scene.kinds[i] == CellKind::kNew;
        if (std::hypot(apart.x(), apart.z()) > 1.2F || !mine) continue;
      }
      person_[i] = static_cast<std::uint8_t>(slot + 1);
    }
  }
}

SplitShare PersonOwners::shareOf(const PeopleScene& scene, const PersonSlot& slot) const {
  SplitShare share;
  share.middle = expected(scene, slot);
  const Isometry3 cameraFromFloor = scene.floorFromCamera.inverse();
  const Vec3 before = cameraFromFloor * slot.middle.cast<double>();
  const Vec3 now = cameraFromFloor * share.middle.cast<double>();
  if (before.z() > -0.1 || now.z() > -0.1) return share;
  const double x = (now.x() / -now.z() - before.x() / -before.z()) * camera_.focalX() / scene.grid.step;
  const double y = -(now.y() / -now.z() - before.y() / -before.z()) * camera_.focalY() / scene.grid.step;
  share.columns = static_cast<int>(std::lround(std::clamp(x, -8.0, 8.0)));
  share.rows = static_cast<int>(std::lround(std::clamp(y, -8.0, 8.0)));
  return share;
}

void PersonOwners::splitBetween(const PeopleScene& scene, std::size_t component, unsigned slotMask, PersonSlots& slots,
                                const LastCells& last) {
  std::array<SplitShare, kPersonSlots> shares{};
  for (int k = 0; k < kPersonSlots; ++k) {
    if ((slotMask & (1U << static_cast<unsigned>(k))) == 0) continue;
    PersonSlot& slot = slots[k];
    slot.seen = true;
    shares[k] = shareOf(scene, slot);
  }
  owner_[component] = kSeveral;
  split_.apply(scene.grid, scene.surfaces, scene.positions, component, slotMask, shares, last, person_);
}

void PersonOwners::assign(const PeopleScene& scene, PersonSlots& slots) {
  const std::span<const DepthComponent> all = scene.surfaces.components();
  owner_.assign(all.size(), kNobody);
  std::ranges::fill(person_, std::uint8_t{0});
  for (std::size_t i = 0; i < all.size(); ++i) {
    const DepthComponent& one = all[i];
    int best = -1;
    unsigned mask = 0;
    for (int k = 0; k < kPersonSlots; ++k) {
      const int overlap = one.overlap[k];
      if (overlap == 0) continue;
      if (best < 0 || overlap > one.overlap[best]) best = k;
      const PersonSlot& slot = slots[k];
      if (overlap * 12 > one.cells || overlap * 4 > slot.cells) mask |= 1U << static_cast<unsigned>(k);
    }
    if (goesOnIntoBackground(one) && (best < 0 || !slots[best].attached)) {
      owner_[i] = kScenery;
      continue;
    }
    if (best < 0 || one.overlap[best] < std::max(6, one.cells / 50)) continue;
    const auto mine = [&](const Vec3f& axis) { return mayBeHeadOf(scene, slots[best], axis); };
    if (!isMainPiece(one, slots[best].cells, best) && hasOtherHead(scene, i, mine)) continue;
    if ((mask & (mask - 1)) != 0) {
      splitBetween(scene, i, mask, slots, scene.last);
    } else if (!slots[best].confirmed && separateHeads(scene, i, best, slots)) {
      continue;
    } else if (isMainPiece(one, slots[best].cells, best) || awayFrom(scene, one, slots[best]) < kReach) {
      give(scene, i, best, slots);
    }
  }
}

void PersonOwners::giveBirth(const PeopleScene& scene, PersonSlots& slots) {
  const std::span<const DepthComponent> all = scene.surfaces.components();
  const auto anyones = [&](const Vec3f& axis) {
    return std::ranges::any_of(slots, [&](const PersonSlot& slot) { return mayBeHeadOf(scene, slot, axis); });
  };
  for (;;) {
    int best = -1;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (owner_[i] != kNobody) continue;
      if (best >= 0 && all[i].area <= all[best].area) continue;
      const bool whole =
          mayBePerson(all[i], scene.grid, scene.floorFound) || (!isOversize(all[i]) && hasOtherHead(scene, i, anyones));
      if (!whole && (rememberedSlot(scene, slots, all[i]) < 0 || !mayBePartOfPerson(all[i]))) continue;
      best = static_cast<int>(i);
    }
    if (best < 0) return;
    const auto component = static_cast<std::size_t>(best);
    if (separateHeads(scene, component, -1, slots)) continue;
    const int remembered = rememberedSlot(scene, slots, all[component]);
    if (remembered >= 0) {
      slots[remembered].attached = false;  // the room behind was seen meanwhile
      give(scene, component, remembered, slots);
      continue;
    }
    const int free = freeSlot(slots);
    owner_[component] = kMaybe;
    if (free < 0) continue;
    PersonSlot& slot = slots[free];
    slot = newcomer(scene, all[component].middle());
    give(scene, component, free, slots);
    joinPieces(scene, slots);
  }
}

/// Divides a surface with several heads on it between as many people.
/// @param slot  of the one whose surface it was; -1 = nobody's
/// @return whether there are several
bool PersonOwners::separateHeads(const PeopleScene& scene, std::size_t component, int slot, PersonSlots& slots) {
  const std::span<const std::int32_t> label = scene.surfaces.labels();
  std::array<Vec3f, kPersonSlots> axes;
  std::size_t count = 0;
  for (const FoundHead& head : scene.heads) {
    if (label[scene.grid.index(head.column, head.row)] != static_cast<std::int32_t>(component)) continue;
    const Vec3f axis = axisOf(scene, head);
    const auto near = [&](const Vec3f& other) { return horizontally(axis - other) < kHeadsApart; };
    if (count == axes.size() || std::any_of(axes.begin(), axes.begin() + count, near)) continue;
    axes[count++] = axis;
  }
  if (count < 2) return false;
  unsigned mask = 0;
  for (std::size_t h = 0; h < count; ++h) {
    const int mine = h == 0 && slot >= 0 ? slot : freeSlot(slots);
    if (mine < 0) break;
    const int user = mine == slot ? slots[mine].user : 0;
    const bool reported = mine == slot && slots[mine].reported;
    slots[mine] = newcomer(scene, axes[h]);
    slots[mine].user = user;
    slots[mine].reported = reported;
    mask |= 1U << static_cast<unsigned>(mine);
  }
  if ((mask & (mask - 1)) == 0) return false;
  splitBetween(scene, component, mask, slots, LastCells{nobody_, scene.last.depthMm});
  return true;
}

/// What is connected to a head, stands out from the room and is within a person's size belongs to a person.
bool PersonOwners::growFrom(const PeopleScene& scene, const FoundHead& head, int slot) {
  const DepthGrid& grid = scene.grid;
  const auto w = static_cast<std::size_t>(grid.width);
  const Vec3f axis = axisOf(scene, head);
  const Vec3f camera = scene.floorFromCamera.translation().cast<float>();
  Vec3f away = head.position - camera;
  away.y() = 0.0F;
  away.normalize();
  const Vec3f aside = away.cross(Vec3f::UnitY());
  const auto mark = static_cast<std::uint8_t>(slot + 1);
  region_.clear();
  float top = -1e9F, bottom = 1e9F, area = 0.0F;
  const auto take = [&](std::size_t i) {
    if (person_[i] != 0 || grid.depthMm[i] == 0) return false;
    if (scene.kinds[i] == CellKind::kFloor || scene.kinds[i] == CellKind::kWall) return false;
    const Vec3f position = scene.positions(grid, static_cast<int>(i % w), static_cast<int>(i / w));
    const float back = (position - head.position).dot(away);
    if (std::abs((position - axis).dot(aside)) > kGrown || back > kGrownBack || back < -kGrownFront) {
      return false;
    }
    person_[i] = mark;
    region_.push_back(static_cast<std::uint32_t>(i));
    top = std::max(top, position.y());
    bottom = std::min(bottom, position.y());
    const float depth = 0.001F * static_cast<float>(grid.depthMm[i]);
    area += depth * depth * static_cast<float>(grid.cellArea);
    return true;
  };
  take(grid.index(head.column, head.row));
  for (std::size_t next = 0; next < region_.size(); ++next) {
    const std::size_t i = region_[next], column = i % w, row = i / w;
    const float step = kGrownStep * static_cast<float>(grid.depthMm[i]);
    const auto visit = [&](bool inside, std::size_t j) {
      if (inside && static_cast<float>(std::abs(grid.depthMm[i] - grid.depthMm[j])) < step) take(j);
    };
    visit(column > 0, i - 1);
    visit(column + 1 < w, i + 1);
    visit(row > 0, i - w);
    visit(row + 1 < static_cast<std::size_t>(grid.height), i + w);
  }
  if (area > kMinGrown && top - bottom > kMinTall) return true;
  for (const std::uint32_t i : region_) person_[i] = 0;
  return false;
}

/// People whose surface is no person's: connected to furniture, or learnt as background.
void PersonOwners::giveBirthAtHeads(const PeopleScene& scene, PersonSlots& slots) {
  uncovered_.clear();
  if (!scene.looked) return;
  std::swap(waiting_, stillWaiting_);
  waiting_.clear();
  for (const FoundHead& head : scene.heads) {
    const std::size_t cell = scene.grid.index(head.column, head.row);
    if (person_[cell] != 0 || scene.kinds[cell] == CellKind::kFloor || scene.kinds[cell] == CellKind::kWall) continue;
    const Vec3f axis = axisOf(scene, head);
    const bool refused = std::ranges::any_of(refusals_, [&](const Refusal& refusal) {
      return scene.time < refusal.until && horizontally(refusal.middle - axis) < kNeighbour;
    });
    const bool known = std::ranges::any_of(
        slots, [&](const PersonSlot& slot) { return slot.used && horizontally(slot.middle - axis) < kNeighbour; });
    const int free = freeSlot(slots);
    if (refused || known || free < 0) continue;
    // Whoever stands free is found without this in the next frames.
    const auto same = [&](const Vec3f& other) { return horizontally(axis - other) < kHeadsApart; };
    if (std::ranges::none_of(stillWaiting_, same)) {
      waiting_.push_back(axis);
      continue;
    }
    if (!growFrom(scene, head, free)) {
      refuse(axis, scene.time);
      continue;
    }
    slots[free] = newcomer(scene, axis);
    slots[free].seen = true;
    slots[free].attached = true;
    uncovered_.insert(uncovered_.end(), region_.begin(), region_.end());
  }
}

void PersonOwners::joinPieces(const PeopleScene& scene, PersonSlots& slots) {
  const std::span<const DepthComponent> all = scene.surfaces.components();
  const std::span<const std::int32_t> label = scene.surfaces.labels();
  const auto w = static_cast<std::ptrdiff_t>(scene.grid.width);
  for (std::size_t component = 0; component < all.size(); ++component) {
    const DepthComponent& one = all[component];
    if (owner_[component] != kNobody || one.area > 0.4) continue;
    const bool isNew = 2 * one.newCells > one.cells;
    // If the background is not known, a piece that stands on the floor may be a chair as well as a leg.
    if (!isNew && scene.floorFound && one.min.y() < 0.15F) continue;
    float bestGap = isNew ? kGapNew : kGapUnknown;
    int best = -1;
    for (int r = one.top; r <= one.bottom; ++r) {
      for (int c = one.left; c <= one.right; ++c) {
        const std::size_t i = scene.grid.index(c, r);
        if (label[i] != static_cast<std::int32_t>(component)) continue;
        const auto look = [&](std::ptrdiff_t stride, int room) {
          for (int s = 1; s <= std::min(room, kGapCells); ++s) {
            const std::size_t j = i + static_cast<std::size_t>(s * stride);
            if (label[j] == static_cast<std::int32_t>(component)) return;
            if (person_[j] == 0) continue;
            const int slot = person_[j] - 1;
            const Vec3f there = scene.positions(scene.grid, static_cast<int>(j % static_cast<std::size_t>(w)),
                                                static_cast<int>(j / static_cast<std::size_t>(w)));
            const float gap = (there - scene.positions(scene.grid, c, r)).norm();
            if (gap < bestGap) {
              bestGap = gap;
              best = slot;
            }
            return;
          }
        };
        look(-1, c);
        look(1, scene.grid.width - 1 - c);
        look(-w, r);
        look(w, scene.grid.height - 1 - r);
      }
    }
    if (best < 0) continue;
    // A person who has gone behind another one may show beside them.
    const int hidden = isNew ? rememberedSlot(scene, slots, one) : -1;
    if (hidden >= 0 && awayFrom(scene, one, slots[hidden]) < awayFrom(scene, one, slots[best])) {
      best = hidden;
    }
    const auto mine = [&](const Vec3f& axis) { return mayBeHeadOf(scene, slots[best], axis); };
    if (hasOtherHead(scene, component, mine)) continue;
    if (awayFrom(scene, one, slots[best]) < kReach) give(scene, component, best, slots);
  }
}

}  // namespace lorica
