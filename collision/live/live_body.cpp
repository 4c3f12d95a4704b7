#include "collision/live/live_body.h"

#include "acd/transfer.h"
#include "collision/live/extent_kernel.h"
#include "collision/live/lifted_kernel.h"
#include "collision/live/moving_hull.h"
#include "collision/live/part_plan.h"
#include "collision/live/rigid_fit.h"
#include "geometry/clock.h"
#include "geometry/threads.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <numeric>
#include <utility>

namespace lorica {
namespace {

using Clock = std::chrono::steady_clock;

// A part extends 2^20 to 2^21 ticks from its mean: a tick is less than a millionth of its size. MovingHull accepts up
// to kMaxTicks. Coarser ticks would round more points onto each other's planes, which costs time.
constexpr int kTickBits = 21;
constexpr float kSmallest = 65536.0f;  // 2^16: below this, ticks are refined

/// The tick for a part that extends this far from its mean; a power of two.
double tickFor(double reach) {
  return reach > 0.0 && std::isfinite(reach) ? std::ldexp(1.0, std::ilogb(reach) + 1 - kTickBits) : 0.0;
}

// With as many points, hulls take some 50 us on one core.
constexpr std::size_t kManyPoints = 4096;

constexpr double kFarthest = 1e6;  // of a part that physics can use: it computes in single precision [m]

bool isFinite(const Isometry3& motion) {
  return motion.matrix().allFinite();
}

}  // namespace

struct LiveBody::Track {
  std::vector<PointRow> rows;             ///< of the candidates, in the part's own frame, in whole ticks
  double tick = 0.0;                      ///< [m]
  bool inRange = false;                   ///< whether all rows are numbers that the hull can compute with
  bool usable = false;                    ///< the hull is that of the rows; else there is none
  bool moved = false;                     ///< the rows differ from the previous frame's
  std::optional<MovingHull> hull;         ///< if faces are wanted
  LiftedPart::TakenPose taken;            ///< characters only
  std::vector<Vec3> firstPoints, points;  ///< mesh sequences only: in the first frame about their mean, and now
  std::size_t nthLargest = 0;             ///< the part that has this track's place by number of points
};

LiveBody::LiveBody(LiveBody&&) noexcept = default;
LiveBody& LiveBody::operator=(LiveBody&&) noexcept = default;
LiveBody::~LiveBody() = default;

LiveBody::LiveBody(std::shared_ptr<const BodyPlan> plan, LiveDetail detail) : plan_(std::move(plan)), detail_(detail) {
  LORICA_CHECK(plan_ != nullptr, "a live body needs a plan");
  tracks_.resize(plan_->parts_.size());
  parts_.resize(tracks_.size());
  covariances_.resize(tracks_.size());
  rotations_.resize(tracks_.size());
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const BodyPlan::PartPlan& own = plan_->parts_[i];
    const std::size_t count = own.candidates.size();
    Track& track = tracks_[i];
    if (own.lifted) {
      track.rows.resize(own.lifted->rowCount());
      track.tick = tickFor(own.lifted->radius());
      track.taken = own.lifted->noPose();
    } else {
      track.rows.resize(count);
      track.points.resize(count);
      track.firstPoints.resize(count);
      meshPoints_.resize(decomposition().pointCount(), Vec3::Zero());
    }
    if (detail != LiveDetail::kFaces) continue;
    track.hull.emplace(count);
    LivePart& part = parts_[i];
    part.shape.vertices.reserve(count);
    part.shape.pointOfVertex.reserve(count);
    part.shape.triangles.reserve(2 * count);
    part.previousVertices.reserve(count);
  }
  std::vector<std::size_t> bySize(tracks_.size());
  std::iota(bySize.begin(), bySize.end(), std::size_t{0});
  std::stable_sort(bySize.begin(), bySize.end(), [&](std::size_t a, std::size_t b) {
    return plan_->parts_[a].candidates.size() > plan_->parts_[b].candidates.size();
  });
  for (std::size_t i = 0; i < tracks_.size(); ++i) tracks_[i].nthLargest = bySize[i];
}

// The constructor reserves capacity and assignment keeps it; a default copy would have none to spare.
LiveBody::LiveBody(const LiveBody& other) : LiveBody(other.plan_, other.detail_) {
  tracks_ = other.tracks_;
  parts_ = other.parts_;
  meshPoints_ = other.meshPoints_;
  timing_ = other.timing_;
  started_ = other.started_;
}

LiveBody& LiveBody::operator=(const LiveBody& other) {
  if (this != &other) *this = LiveBody(other);
  return *this;
}

Result<LiveBody> LiveBody::create(Decomposition decomposition, const Character& character,
                                  std::optional<HullCover> cover, LiveDetail detail) {
  LORICA_TRY(std::shared_ptr<const BodyPlan> plan,
             BodyPlan::create(std::move(decomposition), character, std::move(cover)));
  return LiveBody(std::move(plan), detail);
}

Result<LiveBody> LiveBody::create(Decomposition decomposition) {
  LORICA_TRY(std::shared_ptr<const BodyPlan> plan, BodyPlan::create(std::move(decomposition)));
  return LiveBody(std::move(plan));
}

Vec3 LiveBody::support(PartIndex part, const Vec3& direction) const {
  const Track& track = tracks_[part];
  const Isometry3& worldFromPart = parts_[part].worldFromPart;
  const Vec3f own = (worldFromPart.linear().transpose() * direction).cast<float>();
  const std::span<const PointRow> rows = std::span(track.rows).first(candidateCount(part));
  const PointRow& row = rows[farthestRow(rows, own)];
  return worldFromPart * (track.tick * Vec3(row.x, row.y, row.z));
}

std::size_t LiveBody::candidateCount(PartIndex part) const {
  return plan_->parts_[part].candidates.size();
}

std::size_t LiveBody::memory() const {
  const auto bytes = [](const auto& vector) { return vector.capacity() * sizeof(vector[0]); };
  std::size_t sum = bytes(meshPoints_) + bytes(covariances_) + bytes(rotations_) + bytes(parts_) + bytes(tracks_);
  for (const Track& t : tracks_) {
    sum += bytes(t.rows) + bytes(t.taken) + bytes(t.firstPoints) + bytes(t.points);
    if (t.hull) sum += t.hull->memory();
  }
  for (const LivePart& part : parts_) {
    sum += bytes(part.shape.vertices) + bytes(part.shape.pointOfVertex) + bytes(part.shape.triangles) +
           bytes(part.previousVertices);
  }
  return sum;
}

void LiveBody::update(std::span<const Affine3> worldFromModel) {
  LORICA_CHECK(meshPoints_.empty(), "the body of a mesh sequence must be updated with vertex positions");
  const Clock::time_point begin = Clock::now();

  for (std::size_t i = 0; i < parts_.size(); ++i) {
    LivePart& part = parts_[i];
    part.previousWorldFromPart = part.worldFromPart;
    const LiftedPart::Moments moments = plan_->parts_[i].lifted->momentsOf(worldFromModel);
    part.worldFromPart.translation() = moments.mean;
    covariances_[i] = moments.covariance;
    rotations_[i] = part.previousWorldFromPart.linear();
  }
  fitRotations(covariances_, rotations_);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    LivePart& part = parts_[i];
    part.worldFromPart.linear() = rotations_[i];
    if (!started_) part.previousWorldFromPart = part.worldFromPart;
  }
  const Clock::time_point placed = Clock::now();

  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const LiftedPart& lifted = *plan_->parts_[i].lifted;
    Track& track = tracks_[i];
    if (i + 1 < parts_.size()) {
      fetch(std::as_bytes(std::span(tracks_[i + 1].taken)));
      fetch(std::as_bytes(std::span(tracks_[i + 1].rows)));
    }
    // Several rounds, in case a pose is so much larger or smaller than the last one that it needs other ticks.
    for (int round = 0; round < 4; ++round) {
      const bool taken = lifted.take(worldFromModel, parts_[i].worldFromPart, track.tick, track.taken);
      if (round == 0) track.moved = taken;
      if (!taken || !isFinite(parts_[i].worldFromPart)) break;
      const float largest = lifted.evaluate(track.taken, track.rows);
      track.inRange = largest <= kMaxTicks;  // not if it is no number
      if (largest >= kSmallest && track.inRange) break;
      // After a pose out of all proportion, ticks say nothing about the size: those of the bind pose are tried.
      double tick = tickFor(track.tick * largest);
      if (tick == 0.0) tick = tickFor(lifted.radius());
      if (tick == track.tick || tick == 0.0) break;
      track.tick = tick;
    }
  }
  const Clock::time_point carried = Clock::now();

  reshapeAll();
  const Clock::time_point end = Clock::now();
  timing_ = {microsecondsBetween(begin, placed), microsecondsBetween(placed, carried),
             microsecondsBetween(carried, end)};
}

void LiveBody::update(std::span<const Vec3> posed) {
  LORICA_CHECK(!meshPoints_.empty(), "the body of a character must be updated with bone transforms");
  const Clock::time_point begin = Clock::now();

  transfer(decomposition(), posed, meshPoints_);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const std::vector<PointIndex>& candidates = plan_->parts_[i].candidates;
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      tracks_[i].points[k] = meshPoints_[candidates[k]];
    }
  }
  const Clock::time_point carried = Clock::now();

  for (std::size_t i = 0; i < parts_.size(); ++i) {
    Track& track = tracks_[i];
    LivePart& part = parts_[i];
    if (!started_) {
      part.worldFromPart.translation() = centroidOf(track.points);
      part.previousWorldFromPart = part.worldFromPart;
      for (std::size_t k = 0; k < track.points.size(); ++k) {
        track.firstPoints[k] = track.points[k] - part.worldFromPart.translation();
      }
    } else {
      part.previousWorldFromPart = part.worldFromPart;
      part.worldFromPart = fitRigidMotion(track.firstPoints, track.points, part.previousWorldFromPart.linear());
    }
  }
  const Clock::time_point placed = Clock::now();

  for (std::size_t i = 0; i < parts_.size(); ++i) readRows(tracks_[i], parts_[i].worldFromPart);
  reshapeAll();
  const Clock::time_point end = Clock::now();
  timing_ = {microsecondsBetween(carried, placed), microsecondsBetween(begin, carried),
             microsecondsBetween(placed, end)};
}

/// Transforms points of a mesh sequence to the part's own frame, in ticks.
void LiveBody::readRows(Track& track, const Isometry3& worldFromPart) {
  const Isometry3 partFromWorld = worldFromPart.inverse();
  double reach = 0.0;
  track.inRange = true;
  for (Vec3& p : track.points) {
    p = partFromWorld * p;
    reach = std::max(reach, p.cwiseAbs().maxCoeff());
    track.inRange = track.inRange && p.allFinite();
  }
  const double largest = track.tick > 0.0 ? reach / track.tick : 0.0;
  if (!(largest >= kSmallest && largest <= kMaxTicks)) track.tick = tickFor(reach);
  const double ticks = track.tick > 0.0 ? 1.0 / track.tick : 0.0;
  for (std::size_t k = 0; k < track.points.size(); ++k) {
    const Vec3f p = (ticks * track.points[k]).array().round().cast<float>();
    track.rows[k] = {p.x(), p.y(), p.z(), 0.0f};
  }
  track.moved = true;
}

/// Updates all hulls: on all cores if that takes long enough to wake them.
void LiveBody::reshapeAll() {
  std::size_t moved = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) moved += tracks_[i].moved ? plan_->parts_[i].candidates.size() : 0;
  if (moved >= kManyPoints && detail_ == LiveDetail::kFaces) {
    const std::size_t largest = plan_->parts_[tracks_.front().nthLargest].candidates.size();
    std::atomic<std::size_t> next = 0;
    parallelPieces(parts_.size(), [&](std::size_t) {
      MovingHull::prepareThread(largest);
      const std::size_t part = tracks_[next++].nthLargest;
      reshape(plan_->parts_[part], tracks_[part], parts_[part]);
    });
  } else {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      if (i + 1 < parts_.size() && tracks_[i + 1].moved) {
        if (tracks_[i + 1].hull) tracks_[i + 1].hull->fetch();
        fetch(parts_[i + 1].previousVertices);
        fetch(std::as_bytes(std::span(parts_[i + 1].shape.triangles)));
      }
      reshape(plan_->parts_[i], tracks_[i], parts_[i]);
    }
  }
  started_ = true;
}

/// Updates the hull from the rows.
void LiveBody::reshape(const BodyPlan::PartPlan& plan, Track& track, LivePart& part) {
  // A part may come back from afar in the shape in which it left.
  const bool usable = track.inRange && track.tick != 0.0 && isFinite(part.worldFromPart) &&
                      part.worldFromPart.translation().cwiseAbs().maxCoeff() <= kFarthest;
  part.reshaped = track.moved || usable != track.usable;
  track.usable = usable;
  if (!part.reshaped) return;
  std::swap(part.previousVertices, part.shape.vertices);
  const MovingHull* hull = nullptr;
  if (track.hull && usable) {
    track.hull->update(std::span(track.rows).first(plan.candidates.size()));
    hull = &*track.hull;
  }
  const std::span<const VertexIndex> vertices = hull ? hull->vertices() : std::span<const VertexIndex>();
  const std::span<const Triangle> faces = hull ? hull->faces() : std::span<const Triangle>();
  part.shape.volume = hull ? hull->volume() * track.tick * track.tick * track.tick : 0.0;
  part.shape.vertices.resize(vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const PointRow& row = track.rows[vertices[v]];
    part.shape.vertices[v] = track.tick * Vec3(row.x, row.y, row.z);
  }
  part.radius = std::sqrt(farthestSq(part.shape.vertices));
  // The lists stay in half of all frames of small hulls. They are empty after a frame without a hull.
  if (hull && hull->keptFaces() && part.shape.triangles.size() == faces.size()) return;
  part.shape.pointOfVertex.resize(vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    part.shape.pointOfVertex[v] = plan.candidates[vertices[v]];
  }
  part.shape.triangles.resize(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const auto& [a, b, c] = faces[f];
    part.shape.triangles[f] = {hull->positionOf(a), hull->positionOf(b), hull->positionOf(c)};
  }
}

}  // namespace lorica
