#include "collision/live_body.h"

#include "acd/transfer.h"
#include "collision/cover.h"
#include "collision/lifted_kernel.h"
#include "collision/rigid_fit.h"
#include "geometry/result.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace lorica {
namespace {

using Clock = std::chrono::steady_clock;

double microsecondsBetween(Clock::time_point begin, Clock::time_point end) {
  return std::chrono::duration<double, std::micro>(end - begin).count();
}

// A part reaches 2^20 to 2^21 ticks from its mean: less than a millionth of its size is one. MovingHull takes up to
// 2^22. Coarser ticks round more points onto each other's planes, which makes work.
constexpr int kTickBits = 21;
constexpr float kLargest = 4194304.0f;  // 2^22
constexpr float kSmallest = 65536.0f;   // 2^16: below, ticks are made finer

/// The tick for a part that reaches so far from its mean; a power of two.
double tickFor(double reach) {
  return reach > 0.0 && std::isfinite(reach) ? std::ldexp(1.0, std::ilogb(reach) + 1 - kTickBits) : 0.0;
}

bool isFinite(const Isometry3& motion) {
  return motion.matrix().allFinite();
}

}  // namespace

LiveBody::LiveBody(Decomposition decomposition, const Character& character, LiveDetail detail)
    : decomposition_(std::move(decomposition)), detail_(detail) {
  const std::vector<LiftedPoint> lifted = liftPoints(character, decomposition_);
  cover_ = coverExactly(decomposition_, lifted);
  addTracks(lifted);
}

LiveBody::LiveBody(Decomposition decomposition, const Character& character, CoverPromise cover, LiveDetail detail)
    : decomposition_(std::move(decomposition)), cover_(std::move(cover)), detail_(detail) {
  CHECK(cover_.points.size() == decomposition_.parts.size(), "a promise says for each part which points it is made of");
  addTracks(liftPoints(character, decomposition_));
}

void LiveBody::addTracks(std::span<const LiftedPoint> lifted) {
  tracks_.reserve(decomposition_.parts.size());
  for (const std::vector<CoverPoint>& chosen : cover_.points) {
    std::vector<LiftedPoint> points;
    points.reserve(chosen.size());
    for (const CoverPoint& p : chosen) points.push_back(pushed(lifted[static_cast<std::size_t>(p.point)], p.outward));
    LiftedPart packed(points);
    std::vector<PointIndex> rows;
    rows.reserve(chosen.size());
    for (const std::int32_t i : packed.order()) rows.push_back(chosen[static_cast<std::size_t>(i)].point);
    Track track(std::move(rows));
    track.rows.resize(packed.rowCount());
    track.tick = tickFor(packed.radius());
    track.lifted.emplace(std::move(packed));
    addTrack(std::move(track));
  }
}

LiveBody::LiveBody(Decomposition decomposition) : decomposition_(std::move(decomposition)) {
  meshPoints_.resize(static_cast<std::size_t>(decomposition_.pointCount()), Vec3::Zero());
  tracks_.reserve(decomposition_.parts.size());
  for (const Part& part : decomposition_.parts) {
    Track track(spanningPoints(decomposition_, part));
    std::vector<CoverPoint>& chosen = cover_.points.emplace_back();
    chosen.reserve(track.candidates.size());
    for (const PointIndex p : track.candidates) chosen.push_back({p, Vec3::Zero()});
    track.rows.resize(track.candidates.size());
    track.points.resize(track.candidates.size());
    track.firstPoints.resize(track.candidates.size());
    addTrack(std::move(track));
  }
}

void LiveBody::addTrack(Track track) {
  const std::size_t count = track.candidates.size();
  CHECK(count > 0, "a decomposition has a part without points");
  vertexOfCandidate_.resize(std::max(vertexOfCandidate_.size(), count));
  LivePart part;
  if (detail_ == LiveDetail::kFaces) {
    track.hull.emplace(static_cast<int>(count));
    part.shape.vertices.reserve(count);
    part.shape.pointOfVertex.reserve(count);
    part.shape.triangles.reserve(2 * count);
    part.previousVertices.reserve(count);
  }
  parts_.push_back(std::move(part));
  tracks_.push_back(std::move(track));
}

Vec3 LiveBody::support(PartIndex part, const Vec3& direction) const {
  const Track& track = tracks_[static_cast<std::size_t>(part)];
  const Isometry3& worldFromPart = parts_[static_cast<std::size_t>(part)].worldFromPart;
  const Vec3f own = (worldFromPart.linear().transpose() * direction).cast<float>();
  const std::span<const PointRow> rows = std::span(track.rows).first(track.candidates.size());
  const PointRow& row = rows[static_cast<std::size_t>(farthestRow(rows, own))];
  return worldFromPart * (track.tick * Vec3(row.x, row.y, row.z));
}

std::size_t LiveBody::candidateCount(PartIndex part) const {
  return tracks_[static_cast<std::size_t>(part)].candidates.size();
}

std::size_t LiveBody::memory() const {
  const auto bytes = [](const auto& vector) { return vector.capacity() * sizeof(vector[0]); };
  std::size_t sum = bytes(meshPoints_) + bytes(vertexOfCandidate_) + bytes(parts_) + bytes(tracks_);
  for (const Track& t : tracks_) {
    sum += bytes(t.candidates) + bytes(t.rows) + bytes(t.firstPoints) + bytes(t.points);
    if (t.hull) sum += t.hull->memory();
    if (t.lifted) sum += t.lifted->memory();
  }
  for (const LivePart& part : parts_) {
    sum += bytes(part.shape.vertices) + bytes(part.shape.pointOfVertex) + bytes(part.shape.triangles) +
           bytes(part.previousVertices);
  }
  return sum;
}

void LiveBody::update(std::span<const Affine3> worldFromModel) {
  CHECK(meshPoints_.empty(), "a mesh sequence's body is moved by its vertices");
  const Clock::time_point begin = Clock::now();

  for (std::size_t i = 0; i < parts_.size(); ++i) {
    LivePart& part = parts_[i];
    part.previousWorldFromPart = part.worldFromPart;
    part.worldFromPart = tracks_[i].lifted->place(worldFromModel, part.previousWorldFromPart.linear());
    if (!started_) part.previousWorldFromPart = part.worldFromPart;
  }
  const Clock::time_point placed = Clock::now();

  for (std::size_t i = 0; i < parts_.size(); ++i) {
    Track& track = tracks_[i];
    // A few rounds, where a pose is so much larger or smaller than the last one that it needs other ticks.
    for (int round = 0; round < 4; ++round) {
      const bool taken = track.lifted->take(worldFromModel, parts_[i].worldFromPart, track.tick);
      if (round == 0) track.moved = taken;
      if (!taken || !isFinite(parts_[i].worldFromPart)) break;
      const float largest = track.lifted->evaluate(track.rows);
      if (largest >= kSmallest && largest <= kLargest) break;
      const double tick = tickFor(track.tick * static_cast<double>(largest));
      if (tick == 0.0) break;
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
  CHECK(!meshPoints_.empty(), "a character's body is moved by its bones");
  const Clock::time_point begin = Clock::now();

  transfer(decomposition_, posed, meshPoints_);
  for (Track& track : tracks_) {
    for (std::size_t k = 0; k < track.candidates.size(); ++k) {
      track.points[k] = meshPoints_[static_cast<std::size_t>(track.candidates[k])];
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

/// Points of a mesh sequence into the part's own frame, in ticks.
void LiveBody::readRows(Track& track, const Isometry3& worldFromPart) {
  const Isometry3 partFromWorld = worldFromPart.inverse();
  double reach = 0.0;
  for (Vec3& p : track.points) {
    p = partFromWorld * p;
    reach = std::max(reach, p.cwiseAbs().maxCoeff());
  }
  const double largest = track.tick > 0.0 ? reach / track.tick : 0.0;
  if (!(largest >= kSmallest && largest <= kLargest)) track.tick = tickFor(reach);
  const double ticks = track.tick > 0.0 ? 1.0 / track.tick : 0.0;
  for (std::size_t k = 0; k < track.points.size(); ++k) {
    const Vec3f p = (ticks * track.points[k]).array().round().cast<float>();
    track.rows[k] = {p.x(), p.y(), p.z(), 0.0f};
  }
  track.moved = true;
}

void LiveBody::reshapeAll() {
  for (std::size_t i = 0; i < parts_.size(); ++i) reshape(tracks_[i], parts_[i]);
  started_ = true;
}

/// Lets the hull follow the rows.
void LiveBody::reshape(Track& track, LivePart& part) {
  part.reshaped = track.moved;
  if (!track.moved) return;
  std::swap(part.previousVertices, part.shape.vertices);
  part.shape.vertices.clear();
  part.shape.pointOfVertex.clear();
  part.shape.triangles.clear();
  part.shape.volume = 0.0;
  if (!track.hull || track.tick == 0.0 || !isFinite(part.worldFromPart)) return;

  track.hull->update(std::span(track.rows).first(track.candidates.size()));
  for (const std::int32_t candidate : track.hull->vertices()) {
    const auto c = static_cast<std::size_t>(candidate);
    vertexOfCandidate_[c] = static_cast<VertexIndex>(part.shape.vertices.size());
    const PointRow& row = track.rows[c];
    part.shape.pointOfVertex.push_back(track.candidates[c]);
    part.shape.vertices.push_back(track.tick * Vec3(row.x, row.y, row.z));
  }
  for (const Triangle& t : track.hull->faces()) {
    part.shape.triangles.push_back({vertexOfCandidate_[static_cast<std::size_t>(t[0])],
                                    vertexOfCandidate_[static_cast<std::size_t>(t[1])],
                                    vertexOfCandidate_[static_cast<std::size_t>(t[2])]});
  }
  part.shape.volume = track.hull->volume() * track.tick * track.tick * track.tick;
}

}  // namespace lorica
