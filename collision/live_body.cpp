#include "collision/live_body.h"

#include "acd/transfer.h"
#include "collision/rigid_fit.h"
#include "geometry/result.h"

#include <chrono>
#include <utility>

namespace lorica {
namespace {

using Clock = std::chrono::steady_clock;

double microsecondsBetween(Clock::time_point begin, Clock::time_point end) {
  return std::chrono::duration<double, std::micro>(end - begin).count();
}

}  // namespace

LiveBody::LiveBody(Decomposition decomposition)
    : decomposition_(std::move(decomposition)),
      points_(static_cast<std::size_t>(decomposition_.pointCount()), Vec3::Zero()),
      parts_(decomposition_.parts.size()),
      firstPoints_(decomposition_.parts.size()),
      partPoints_(decomposition_.parts.size()) {
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    CHECK(!decomposition_.parts[i].points.empty(), "a decomposition has a part without points");
    partPoints_[i].resize(decomposition_.parts[i].points.size());
  }
}

void LiveBody::update(std::span<const Vec3> posed) {
  CHECK(posed.size() == static_cast<std::size_t>(decomposition_.vertexCount),
        "the pose has another vertex count than the decomposed mesh");
  const Clock::time_point begin = Clock::now();

  transfer(decomposition_, posed, points_);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const std::vector<PointIndex>& indices = decomposition_.parts[i].points;
    for (std::size_t k = 0; k < indices.size(); ++k) {
      partPoints_[i][k] = points_[static_cast<std::size_t>(indices[k])];
    }
  }
  const Clock::time_point transferred = Clock::now();

  for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i].hull = convexHull(partPoints_[i]);
  const Clock::time_point hulled = Clock::now();

  fitMotions();
  const Clock::time_point end = Clock::now();

  timing_.transfer = microsecondsBetween(begin, transferred);
  timing_.hulls = microsecondsBetween(transferred, hulled);
  timing_.motion = microsecondsBetween(hulled, end);
}

void LiveBody::fitMotions() {
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    LivePart& part = parts_[i];
    const std::vector<Vec3>& points = partPoints_[i];
    if (!started_) {
      part.worldFromPart = Isometry3::Identity();
      part.worldFromPart.translation() = centroidOf(points);
      part.previousWorldFromPart = part.worldFromPart;
      firstPoints_[i].reserve(points.size());
      for (const Vec3& p : points) firstPoints_[i].push_back(p - part.worldFromPart.translation());
    } else {
      part.previousWorldFromPart = part.worldFromPart;
      part.worldFromPart = fitRigidMotion(firstPoints_[i], points, part.previousWorldFromPart.linear());
    }
    const Isometry3 partFromWorld = part.worldFromPart.inverse();
    part.residual.resize(part.hull.vertices.size());
    for (std::size_t v = 0; v < part.residual.size(); ++v) part.residual[v] = partFromWorld * part.hull.vertices[v];
  }
  started_ = true;
}

}  // namespace lorica
