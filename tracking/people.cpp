#include "tracking/people.h"

#include "geometry/result.h"
#include "tracking/background.h"
#include "tracking/components.h"
#include "tracking/depth_grid.h"
#include "tracking/floor.h"
#include "tracking/person_gates.h"
#include "tracking/person_image.h"
#include "tracking/person_moves.h"
#include "tracking/person_split.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace lorica {

namespace {

constexpr double kRemembered = 2.0;      // seconds that a person keeps the number out of sight
constexpr int kLeastCells = 20;          // of a person who is seen
constexpr float kReach = 0.9F;           // from the middle of a person to that of any piece, horizontally [m]
constexpr float kGapNew = 0.35F;         // between pieces of a person in front of known background [m]
constexpr float kGapUnknown = 0.25F;     // and where it is not known [m]
constexpr int kGapCells = 10;            // that noise and shadows may take out between pieces
constexpr int kHeightBins = 256;         // of 2 cm, from 0.5 m under the floor
constexpr float kLeastHeight = 1.1F;     // of whoever does not move, over the floor [m]
constexpr int kMovingFrames = 3;         // in a row, until someone has moved
constexpr double kStillSeconds = 3.0;    // that furniture may be taken for a person
constexpr double kPersonSeconds = 20.0;  // that someone with head and shoulders may stand like a post

/// A person who is followed, or remembered.
struct Slot {
  bool used = false;
  bool seen = false;      ///< in this frame
  bool reported = false;  ///< and to be told of
  bool moved = false;     ///< since found; furniture does not
  int user = 0;           ///< 0 until reported
  int movingFrames = 0;
  int cells = 0;
  int newCells = 0;
  double born = 0.0, lastSeen = 0.0;  ///< [s]
  Vec3f middle = Vec3f::Zero();       ///< floor frame [m]
  Vec3f velocity = Vec3f::Zero();     ///< [m/s]
  float top = 0.0F;                   ///< height of the highest cells but a few [m]
  bool cutAbove = false;              ///< by the image's upper border
  bool cutAside = false;              ///< by one of its sides
  Vec3f sum = Vec3f::Zero();
  std::array<int, kHeightBins> heights{};  ///< cells at each height
};

}  // namespace

struct PeopleFinder::Impl {
  Impl(const DepthCamera& depthCamera, int most);

  void classify();
  void assign();
  void giveBirth();
  void joinPieces();
  void measure();
  void giveUpFurniture(bool floorIsNew);
  void report();
  void paint(std::span<const std::uint16_t> depthMm);
  void find(const DepthFrame& frame);

  [[nodiscard]] Vec3f expected(const Slot& slot) const {
    return slot.middle + static_cast<float>(elapsed) * slot.velocity;
  }
  /// Along the floor, from the middle of a surface to where a person's is expected [m].
  [[nodiscard]] float awayFrom(const DepthComponent& one, const Slot& slot) const;
  [[nodiscard]] int freeSlot() const;
  [[nodiscard]] int rememberedSlot(const DepthComponent& one) const;
  void give(std::size_t component, int slot);
  void splitBetween(std::size_t component, unsigned slotMask);
  [[nodiscard]] SplitShare shareOf(const Slot& slot) const;
  [[nodiscard]] bool looksLikePerson(const Slot& slot) const;

  DepthCamera camera;
  int maxPeople;
  DepthGrid grid;
  FloorFinder floor;
  FloorPlaces places;
  Background background;
  ComponentFinder finder;
  PersonSplit split;
  PersonMoves moves;
  DepthTable floorNoise;  ///< of heights over the floor, for a camera 1 m up [m]

  std::vector<CellKind> kinds;
  std::vector<std::uint8_t> person, lastPerson;  ///< slot + 1
  std::vector<std::uint8_t> taken;
  std::vector<std::uint16_t> lastDepthMm;
  std::vector<int> owner;  ///< of components: slot, or kNobody, kMaybe, kSeveral
  std::array<Slot, kPersonSlots> slots;
  double time = 0.0, elapsed = 0.0;
  bool started = false;

  std::vector<PersonSegment> people;
  std::vector<std::uint8_t> labels;
  Isometry3 floorFromCamera = Isometry3::Identity();
};

namespace {

constexpr int kNobody = -1;
constexpr int kMaybe = -2;    // a person for whom there is no room
constexpr int kSeveral = -3;  // shared out between people already
constexpr int kScenery = -4;  // goes on into the background

}  // namespace

PeopleFinder::Impl::Impl(const DepthCamera& depthCamera, int most)
    : camera(depthCamera),
      maxPeople(std::clamp(most, 1, kPersonSlots - 2)),
      grid(depthCamera),
      floor(grid),
      places(grid),
      background(grid),
      finder(grid),
      split(grid),
      moves(grid),
      floorNoise([](double depth) { return 2.5 * depthNoise(static_cast<float>(depth)) / depth; }),
      kinds(grid.cellCount()),
      person(grid.cellCount()),
      lastPerson(grid.cellCount()),
      taken(grid.cellCount()),
      lastDepthMm(grid.cellCount()),
      labels(static_cast<std::size_t>(depthCamera.width) * static_cast<std::size_t>(depthCamera.height)) {
  owner.reserve(2048);
  people.reserve(kPersonSlots);
  floorFromCamera = floor.floorFromCamera();
}

void PeopleFinder::Impl::classify() {
  std::ranges::fill(kinds, CellKind::kNone);
  if (floor.found()) {
    const float height = places.cameraHeight();
    for (int r = 0; r < grid.height; ++r) {
      for (int c = 0; c < grid.width; ++c) {
        const std::size_t i = grid.index(c, r);
        const std::uint16_t depthMm = grid.depthMm[i];
        const float above = 0.001F * static_cast<float>(depthMm) * places.slope(c, r) + height;
        if (depthMm != 0 && above < 0.008F + floorNoise[depthMm] * height) kinds[i] = CellKind::kFloor;
      }
    }
  }
  background.classify(grid, kinds);
}

float PeopleFinder::Impl::awayFrom(const DepthComponent& one, const Slot& slot) const {
  const Vec3f apart = one.middle() - expected(slot);
  return std::hypot(apart.x(), apart.z());
}

int PeopleFinder::Impl::freeSlot() const {
  for (int k = 0; k < kPersonSlots; ++k) {
    if (!slots[static_cast<std::size_t>(k)].used) return k;
  }
  return -1;
}

int PeopleFinder::Impl::rememberedSlot(const DepthComponent& one) const {
  int best = -1;
  float bestDistance = 0.0F;
  for (int k = 0; k < kPersonSlots; ++k) {
    const Slot& slot = slots[static_cast<std::size_t>(k)];
    if (!slot.used || slot.seen) continue;
    const auto away = static_cast<float>(time - slot.lastSeen);
    const Vec3f apart = one.middle() - slot.middle;
    const float distance = std::hypot(apart.x(), apart.z());
    if (distance > std::min(0.6F + 1.5F * away, 1.8F) || (best >= 0 && distance >= bestDistance)) continue;
    best = k;
    bestDistance = distance;
  }
  return best;
}

void PeopleFinder::Impl::give(std::size_t component, int slot) {
  const DepthComponent& one = finder.components()[component];
  owner[component] = slot;
  slots[static_cast<std::size_t>(slot)].seen = true;
  const std::span<const std::int32_t> label = finder.labels();
  const bool whole = !isOversize(one);
  const Vec3f middle = expected(slots[static_cast<std::size_t>(slot)]);
  for (int r = one.top; r <= one.bottom; ++r) {
    for (int c = one.left; c <= one.right; ++c) {
      const std::size_t i = grid.index(c, r);
      if (label[i] != static_cast<std::int32_t>(component)) continue;
      if (!whole) {
        // Grown together with something large: what is near the person, in front of known background, is the person's.
        const Vec3f apart = places(grid, c, r) - middle;
        if (std::hypot(apart.x(), apart.z()) > 1.2F || (lastPerson[i] == 0 && kinds[i] != CellKind::kNew)) continue;
      }
      person[i] = static_cast<std::uint8_t>(slot + 1);
    }
  }
}

SplitShare PeopleFinder::Impl::shareOf(const Slot& slot) const {
  SplitShare share;
  share.middle = expected(slot);
  const Isometry3 cameraFromFloor = floorFromCamera.inverse();
  const Vec3 before = cameraFromFloor * slot.middle.cast<double>();
  const Vec3 now = cameraFromFloor * share.middle.cast<double>();
  if (before.z() > -0.1 || now.z() > -0.1) return share;
  const double x = (now.x() / -now.z() - before.x() / -before.z()) * camera.focalX() / grid.step;
  const double y = -(now.y() / -now.z() - before.y() / -before.z()) * camera.focalY() / grid.step;
  share.columns = static_cast<int>(std::lround(std::clamp(x, -8.0, 8.0)));
  share.rows = static_cast<int>(std::lround(std::clamp(y, -8.0, 8.0)));
  return share;
}

void PeopleFinder::Impl::splitBetween(std::size_t component, unsigned slotMask) {
  std::array<SplitShare, kPersonSlots> shares{};
  for (int k = 0; k < kPersonSlots; ++k) {
    if ((slotMask & (1U << static_cast<unsigned>(k))) == 0) continue;
    Slot& slot = slots[static_cast<std::size_t>(k)];
    slot.seen = true;
    shares[static_cast<std::size_t>(k)] = shareOf(slot);
  }
  owner[component] = kSeveral;
  split.apply(grid, finder, places, component, slotMask, shares, LastCells{lastPerson, lastDepthMm}, person);
}

/// Surfaces that were someone's in the last frame are so now.
void PeopleFinder::Impl::assign() {
  const std::span<const DepthComponent> all = finder.components();
  owner.assign(all.size(), kNobody);
  std::ranges::fill(person, std::uint8_t{0});
  for (std::size_t i = 0; i < all.size(); ++i) {
    const DepthComponent& one = all[i];
    if (goesOnIntoBackground(one)) {
      owner[i] = kScenery;
      continue;
    }
    int best = -1;
    unsigned mask = 0;
    for (int k = 0; k < kPersonSlots; ++k) {
      const int overlap = one.overlap[static_cast<std::size_t>(k)];
      if (overlap == 0) continue;
      if (best < 0 || overlap > one.overlap[static_cast<std::size_t>(best)]) best = k;
      const Slot& slot = slots[static_cast<std::size_t>(k)];
      if (overlap * 12 > one.cells || overlap * 4 > slot.cells) mask |= 1U << static_cast<unsigned>(k);
    }
    if (best < 0 || one.overlap[static_cast<std::size_t>(best)] < std::max(6, one.cells / 50)) continue;
    if ((mask & (mask - 1)) != 0) {
      splitBetween(i, mask);
    } else if (isMainPiece(one, slots[static_cast<std::size_t>(best)].cells, best) ||
               awayFrom(one, slots[static_cast<std::size_t>(best)]) < kReach) {
      give(i, best);
    }
  }
}

/// New people, and those who come back, the largest surface first.
void PeopleFinder::Impl::giveBirth() {
  const std::span<const DepthComponent> all = finder.components();
  for (;;) {
    int best = -1;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (owner[i] != kNobody) continue;
      if (best >= 0 && all[i].area <= all[static_cast<std::size_t>(best)].area) continue;
      const bool whole = mayBePerson(all[i], grid, floor.found());
      if (!whole && (rememberedSlot(all[i]) < 0 || !mayBePartOfPerson(all[i]))) continue;
      best = static_cast<int>(i);
    }
    if (best < 0) return;
    const auto component = static_cast<std::size_t>(best);
    const int remembered = rememberedSlot(all[component]);
    if (remembered >= 0) {
      give(component, remembered);
      continue;
    }
    const int free = freeSlot();
    owner[component] = kMaybe;
    if (free < 0) continue;
    Slot& slot = slots[static_cast<std::size_t>(free)];
    slot = Slot{};
    slot.used = true;
    slot.born = slot.lastSeen = time;
    slot.middle = all[component].middle();
    give(component, free);
    joinPieces();
  }
}

/// Pieces that noise, or a limb in front of the body, cut off: to the person whom they are nearest to.
void PeopleFinder::Impl::joinPieces() {
  const std::span<const DepthComponent> all = finder.components();
  const std::span<const std::int32_t> label = finder.labels();
  const auto w = static_cast<std::ptrdiff_t>(grid.width);
  for (std::size_t component = 0; component < all.size(); ++component) {
    const DepthComponent& one = all[component];
    if (owner[component] != kNobody || one.area > 0.4) continue;
    const bool isNew = 2 * one.newCells > one.cells;
    // Where the background is not known, what stands on the floor may be a chair as well as a leg.
    if (!isNew && floor.found() && one.least.y() < 0.15F) continue;
    float bestGap = isNew ? kGapNew : kGapUnknown;
    int best = -1;
    for (int r = one.top; r <= one.bottom; ++r) {
      for (int c = one.left; c <= one.right; ++c) {
        const std::size_t i = grid.index(c, r);
        if (label[i] != static_cast<std::int32_t>(component)) continue;
        const auto look = [&](std::ptrdiff_t stride, int room) {
          for (int s = 1; s <= std::min(room, kGapCells); ++s) {
            const std::size_t j = i + static_cast<std::size_t>(s * stride);
            if (label[j] == static_cast<std::int32_t>(component)) return;
            if (person[j] == 0) continue;
            const int slot = person[j] - 1;
            const Vec3f there = places(grid, static_cast<int>(j % static_cast<std::size_t>(w)),
                                       static_cast<int>(j / static_cast<std::size_t>(w)));
            const float gap = (there - places(grid, c, r)).norm();
            if (gap < bestGap) {
              bestGap = gap;
              best = slot;
            }
            return;
          }
        };
        look(-1, c);
        look(1, grid.width - 1 - c);
        look(-w, r);
        look(w, grid.height - 1 - r);
      }
    }
    if (best < 0) continue;
    // Someone who has gone behind another one looks out beside him.
    const int hidden = isNew ? rememberedSlot(one) : -1;
    if (hidden >= 0 &&
        awayFrom(one, slots[static_cast<std::size_t>(hidden)]) < awayFrom(one, slots[static_cast<std::size_t>(best)])) {
      best = hidden;
    }
    if (awayFrom(one, slots[static_cast<std::size_t>(best)]) < kReach) give(component, best);
  }
}

void PeopleFinder::Impl::measure() {
  for (Slot& slot : slots) {
    slot.cells = slot.newCells = 0;
    slot.sum.setZero();
    slot.heights.fill(0);
    slot.cutAbove = slot.cutAside = false;
  }
  for (int r = 0; r < grid.height; ++r) {
    for (int c = 0; c < grid.width; ++c) {
      const std::size_t i = grid.index(c, r);
      if (person[i] == 0) continue;
      Slot& slot = slots[person[i] - 1U];
      const Vec3f place = places(grid, c, r);
      ++slot.cells;
      slot.newCells += static_cast<int>(kinds[i] == CellKind::kNew);
      slot.sum += place;
      slot.cutAbove = slot.cutAbove || r <= grid.firstRow + 1;
      slot.cutAside = slot.cutAside || c <= grid.firstColumn + 1 || c >= grid.lastColumn - 1;
      ++slot.heights[static_cast<std::size_t>(
          std::clamp(static_cast<int>((place.y() + 0.5F) * 50.0F), 0, kHeightBins - 1))];
    }
  }
  for (int k = 0; k < kPersonSlots; ++k) {
    Slot& slot = slots[static_cast<std::size_t>(k)];
    if (!slot.used) continue;
    slot.seen = slot.cells >= kLeastCells;
    if (slot.seen) {
      int above = 0, bin = kHeightBins;
      while (bin > 0 && above < 3 + slot.cells / 500) above += slot.heights[static_cast<std::size_t>(--bin)];
      slot.top = 0.02F * static_cast<float>(bin + 1) - 0.5F;
      const Vec3f middle = slot.sum / static_cast<float>(slot.cells);
      const double since = time - slot.lastSeen;
      if (since > 1e-4 && since < 0.2) {
        const Vec3f velocity = (middle - slot.middle) / static_cast<float>(since);
        slot.velocity += 0.4F * (velocity - slot.velocity);
        if (slot.velocity.norm() > 3.0F) slot.velocity *= 3.0F / slot.velocity.norm();
      } else {
        slot.velocity.setZero();
      }
      slot.middle = middle;
      slot.lastSeen = time;
      if (slot.born == time) moves.remember(grid, person, k);
      if (slot.moved) continue;
      const bool isMoving = 20 * slot.newCells > 3 * slot.cells || moves.hasMoved(grid, person, k);
      slot.movingFrames = isMoving ? slot.movingFrames + 1 : 0;
      slot.moved = slot.movingFrames >= kMovingFrames;
    } else if (time - slot.lastSeen > kRemembered) {
      slot = Slot{};
    }
  }
}

/// What never moves is no person, nor is what proves to be low once the floor is known.
void PeopleFinder::Impl::giveUpFurniture(bool floorIsNew) {
  for (int k = 0; k < kPersonSlots; ++k) {
    Slot& slot = slots[static_cast<std::size_t>(k)];
    if (!slot.seen || slot.moved) continue;
    const double age = time - slot.born;
    const bool low =
        floorIsNew && !slot.cutAbove && slot.top < kLeastHeight && slot.cells * 25 < static_cast<int>(person.size());
    const bool likely = age < kStillSeconds ||
                        (age < kPersonSeconds && hasHeadAndShoulders(grid, places, person, k, slot.top, slot.cutAside));
    if (!low && likely) continue;
    for (std::size_t i = 0; i < person.size(); ++i) {
      if (person[i] != k + 1) continue;
      person[i] = 0;
      background.absorb(grid, i);
    }
    slot = Slot{};
  }
}

/// Whoever has moved, or stands free. What is cut off by the image's top or sides may be a shelf as well: it must show
/// head and shoulders.
bool PeopleFinder::Impl::looksLikePerson(const Slot& slot) const {
  if (slot.moved || (!slot.cutAbove && !slot.cutAside)) return true;
  return hasHeadAndShoulders(grid, places, person, static_cast<int>(&slot - slots.data()), slot.top, slot.cutAside);
}

/// The nearest ones, those who move first; whoever is reported stays so.
void PeopleFinder::Impl::report() {
  int reported = 0;
  for (const Slot& slot : slots) reported += static_cast<int>(slot.used && slot.reported);
  for (;;) {
    Slot* next = nullptr;
    Slot* least = nullptr;
    const auto before = [](const Slot& a, const Slot& b) {
      if (a.moved != b.moved) return a.moved;
      return std::hypot(a.middle.x(), a.middle.z()) < std::hypot(b.middle.x(), b.middle.z());
    };
    for (Slot& slot : slots) {
      if (!slot.used) continue;
      if (slot.reported) {
        if (least == nullptr || before(*least, slot)) least = &slot;
      } else if (slot.seen && (next == nullptr || before(slot, *next)) && looksLikePerson(slot)) {
        next = &slot;
      }
    }
    if (next == nullptr) return;
    if (reported == maxPeople) {
      // Furniture gives way to people.
      if (least == nullptr || least->moved || !next->moved) return;
      least->reported = false;
      least->user = 0;
    } else {
      ++reported;
    }
    next->reported = true;
    for (int user = 1; next->user == 0; ++user) {
      const bool given = std::ranges::any_of(slots, [&](const Slot& slot) { return slot.used && slot.user == user; });
      if (!given) next->user = user;
    }
  }
}

/// What the caller sees: people by rising number.
void PeopleFinder::Impl::paint(std::span<const std::uint16_t> depthMm) {
  people.clear();
  std::array<std::uint8_t, kPersonSlots> numbers{};
  for (;;) {
    const Slot* next = nullptr;
    for (const Slot& slot : slots) {
      if (!slot.used || !slot.seen || !slot.reported) continue;
      if (!people.empty() && slot.user <= people.back().user) continue;
      if (next == nullptr || slot.user < next->user) next = &slot;
    }
    if (next == nullptr) break;
    PersonSegment segment;
    segment.user = next->user;
    segment.left = camera.width;
    segment.top = camera.height;
    segment.middle = next->middle.cast<double>();
    segment.topHeight = next->top;
    people.push_back(segment);
    numbers[static_cast<std::size_t>(next - slots.data())] = static_cast<std::uint8_t>(people.size());
  }
  paintPeople(grid, finder, depthMm, numbers, person, people, labels);
}

void PeopleFinder::Impl::find(const DepthFrame& frame) {
  elapsed = started ? std::clamp(frame.time - time, 0.0, 1.0) : 0.0;
  time = frame.time;
  started = true;
  grid.fill(frame.depthMm);
  const bool floorBefore = floor.found();
  floor.update(grid);
  const bool floorIsNew = floor.found() && !floorBefore;
  floorFromCamera = floor.floorFromCamera();
  places.set(grid, floorFromCamera);
  classify();
  finder.find(grid, places, kinds, LastCells{lastPerson, lastDepthMm});
  for (Slot& slot : slots) slot.seen = false;
  assign();
  giveBirth();
  joinPieces();
  measure();
  giveUpFurniture(floorIsNew);

  // The room is learnt from what is nobody's for sure.
  const std::span<const std::int32_t> label = finder.labels();
  for (std::size_t i = 0; i < taken.size(); ++i) {
    const bool maybe = label[i] >= 0 && owner[static_cast<std::size_t>(label[i])] == kMaybe;
    taken[i] = static_cast<std::uint8_t>(person[i] != 0 || maybe);
  }
  background.learn(grid, kinds, taken);
  report();
  paint(frame.depthMm);
  lastPerson = person;
  lastDepthMm = grid.depthMm;
}

PeopleFinder::PeopleFinder(const DepthCamera& camera, int maxPeople)
    : impl_(std::make_unique<Impl>(camera, maxPeople)) {}
PeopleFinder::~PeopleFinder() = default;

void PeopleFinder::find(const DepthFrame& frame) {
  CHECK(frame.depthMm.size() == impl_->labels.size(), "a depth image must have the camera's size");
  impl_->find(frame);
}
std::span<const PersonSegment> PeopleFinder::people() const {
  return impl_->people;
}
std::span<const std::uint8_t> PeopleFinder::labels() const {
  return impl_->labels;
}
const Isometry3& PeopleFinder::floorFromCamera() const {
  return impl_->floorFromCamera;
}
bool PeopleFinder::floorFound() const {
  return impl_->floor.found();
}

}  // namespace lorica
