#include "collision/live/choose_cover.h"

#include "collision/live/attached_vertices.h"
#include "geometry/convex_hull.h"
#include "geometry/errors.h"
#include "geometry/parallel_progress.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <tuple>
#include <utility>

namespace lorica {
namespace {

constexpr int kSweeps = 60;             // over all sampled poses, while pushing points outward
constexpr double kTurn = 0.05;          // per sweep, the rotation of pushes from the faces' normals to outward
constexpr int kShortSweeps = 10;        // with pushes along the faces' normals only
constexpr int kPushes = 20;             // in one pose, before the next one is processed
constexpr double kFarthestLift = 10.0;  // times the part's size: longer pushes diverge
constexpr double kHeld = 1e-7;          // times the part's size: protruding by more than this counts as outside
// Min cosine of the angle between a push and a face's normal that is used in the push length.
constexpr double kSteepest = 0.2;
constexpr double kMore = 1.0 / 64;  // relative extra length of pushes, so that the iteration ends

/// Planes of a hull: unit normals pointing outward, and offsets.
struct Planes {
  Eigen::Matrix<double, Eigen::Dynamic, 3> normals;
  Eigen::VectorXd offsets;
};

Planes planesOf(const ConvexHull& hull) {
  Planes planes;
  planes.normals.resize(hull.triangles.size(), 3);
  planes.offsets.resize(planes.normals.rows());
  for (std::size_t f = 0; f < hull.triangles.size(); ++f) {
    const Vec3 normal = areaNormal(hull.vertices, hull.triangles[f]).stableNormalized();
    planes.normals.row(f) = normal.transpose();
    planes.offsets[f] = normal.dot(hull.vertices[hull.triangles[f][0]]);
  }
  return planes;
}

using Columns = Eigen::Matrix<double, 3, Eigen::Dynamic>;

/// Chooses and pushes the points of one part.
class PartCover {
 public:
  PartCover(std::span<const PointIndex> candidates, std::span<const LiftedPoint> lifted, BonePoseView sampled)
      : candidates_(candidates), lifted_(lifted), sampled_(sampled) {
    lookAt_.resize(sampled.poseCount());
    for (int s = 0; s < sampled.poseCount(); ++s) {
      const std::vector<Vec3> all = positions(sampled, s);
      size_ = std::max(size_, boundsOf(all).diagonal());
      // The point that protrudes farthest is a vertex of the hull of all points, so only those are considered from here
      // on.
      std::vector<VertexIndex> corners = convexHullOutline(all).points;
      Columns& at = lookAt_[s].at;
      at.resize(3, corners.size());
      for (std::size_t i = 0; i < corners.size(); ++i) {
        at.col(i) = all[corners[i]];
      }
      lookAt_[s].candidate = std::move(corners);
    }
  }

  /// Adds points until nothing protrudes by more than the tolerance, or the maximum is reached.
  void choose(double tolerance, std::size_t atMost) {
    takeFirst();
    do {
      takeFarthest(tolerance, atMost);
      shortfall_ = 0.0;
      for (int s = 0; s < sampled_.poseCount(); ++s) shortfall_ = std::max(shortfall_, farthestOut(s).first);
      // How far a point is beyond the planes of faces may grow a little in a pose as points are added elsewhere.
    } while (shortfall_ > tolerance && chosen_.size() < atMost);
  }

  void takeFarthest(double tolerance, std::size_t atMost) {
    // Protrusion in a pose hardly grows while points are added, so an earlier measurement is an upper bound.
    struct Outside {
      double bound;
      int pose;
      bool operator<(const Outside& other) const {
        return bound != other.bound ? bound < other.bound : pose > other.pose;
      }
    };
    std::priority_queue<Outside> poses;
    for (int s = 0; s < sampled_.poseCount(); ++s) poses.push({farthestOut(s).first, s});
    while (poses.top().bound > tolerance && chosen_.size() < atMost) {
      const int pose = poses.top().pose;
      poses.pop();
      const auto [distance, candidate] = farthestOut(pose);
      if (distance > tolerance && (poses.empty() || distance >= poses.top().bound)) take(candidate);
      poses.push({distance, pose});
    }
  }

  /// Pushes the points outward until nothing protrudes in any sampled pose. A point that short pushes cannot cover is
  /// added to the chosen points, as long as the maximum allows.
  /// @return false if this did not converge
  [[nodiscard]] bool grow(std::size_t atMost) {
    findDirections();
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      bool held = true;
      for (int s = 0; s < sampled_.poseCount(); ++s) {
        if (sweep >= kShortSweeps && chosen_.size() < atMost) {
          held = takeOutside(s, atMost) && held;
        } else {
          held = holdIn(s, std::clamp(kTurn * (sweep - kShortSweeps), 0.0, 1.0)) && held;
        }
      }
      if (held) return true;
    }
    return false;
  }

  [[nodiscard]] double shortfall() const { return shortfall_; }

  /// How far the surface protrudes in poses [m].
  [[nodiscard]] double farthestOut(BonePoseView poses) const {
    double farthest = 0.0;
    for (int p = 0; p < poses.poseCount(); ++p) {
      const std::vector<Vec3> all = positions(poses, p);
      const ConvexHull hull = convexHull(chosenPositions(poses, p));
      if (!hull.degenerate()) {
        farthest = std::max(farthest, largestViolation(hull, all));
      } else if (!convexHull(all).degenerate()) {
        farthest = std::max(farthest, boundsOf(all).diagonal());
      }
    }
    return farthest;
  }

  [[nodiscard]] std::vector<CoverPoint> points() const {
    std::vector<CoverPoint> points;
    points.reserve(chosen_.size());
    for (const Chosen& c : chosen_) {
      points.push_back({candidates_[c.candidate], c.push});
    }
    std::sort(points.begin(), points.end(), [](const CoverPoint& a, const CoverPoint& b) { return a.point < b.point; });
    return points;
  }

  [[nodiscard]] double longestPush() const {
    double longest = 0.0;
    for (const Chosen& c : chosen_) longest = std::max(longest, c.push.norm());
    return longest;
  }

 private:
  struct Chosen {
    VertexIndex candidate = 0;
    Vec3 direction = Vec3::Zero();  ///< of its push, in the bind pose
    Vec3 push = Vec3::Zero();       ///< in the bind pose [m]
  };
  struct LookAt {
    std::vector<VertexIndex> candidate;
    Columns at;
  };

  [[nodiscard]] const LiftedPoint& point(VertexIndex candidate) const { return lifted_[candidates_[candidate]]; }

  [[nodiscard]] std::vector<Vec3> positions(BonePoseView poses, int p) const {
    std::vector<Vec3> at;
    at.reserve(candidates_.size());
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      at.push_back(positionOf(point(i), poses.pose(p)));
    }
    return at;
  }

  /// Linear map that a point's bones apply to anything fixed to its surface.
  [[nodiscard]] static Mat3 turnOf(const LiftedPoint& point, std::span<const Affine3> worldFromModel) {
    Mat3 turn = Mat3::Zero();
    for (const LiftedTerm& t : point) turn += t.weight * worldFromModel[t.joint].linear();
    return turn;
  }

  [[nodiscard]] std::vector<Vec3> chosenPositions(BonePoseView poses, int p) const {
    std::vector<Vec3> at;
    at.reserve(chosen_.size());
    for (const Chosen& c : chosen_) {
      at.push_back(positionOf(point(c.candidate), poses.pose(p)));
      if (!c.push.isZero()) at.back() += turnOf(point(c.candidate), poses.pose(p)) * c.push;
    }
    return at;
  }

  void take(VertexIndex candidate) { chosen_.push_back({candidate, Vec3::Zero()}); }

  /// Takes four points that span a volume in the first pose, or all if there are fewer.
  void takeFirst() {
    const std::vector<Vec3> at = positions(sampled_, 0);
    const auto takeFarthest = [&](const auto& distance) {
      VertexIndex best = 0;
      for (std::size_t i = 1; i < at.size(); ++i) {
        if (distance(at[i]) > distance(at[best])) best = i;
      }
      if (!isChosen(best)) take(best);
      return at[best];
    };
    const Vec3 middle = boundsOf(at).center();
    const Vec3 a = takeFarthest([&](const Vec3& p) { return (p - middle).norm(); });
    const Vec3 b = takeFarthest([&](const Vec3& p) { return (p - a).norm(); });
    const Vec3 c = takeFarthest([&](const Vec3& p) { return (p - a).cross(b - a).norm(); });
    const Vec3 normal = (b - a).cross(c - a);
    takeFarthest([&](const Vec3& p) { return std::abs(normal.dot(p - a)); });
  }

  /// The largest protrusion from the chosen points' hull in a sampled pose [m], and its candidate.
  [[nodiscard]] std::pair<double, VertexIndex> farthestOut(int pose) const {
    const LookAt& look = lookAt_[pose];
    const ConvexHull hull = convexHull(chosenPositions(sampled_, pose));
    if (hull.degenerate()) {
      // Flat so far: take the point farthest from the chosen ones next.
      const Vec3 from = hull.vertices.empty() ? Vec3(look.at.col(0)) : boundsOf(hull.vertices).center();
      Eigen::Index farthest = 0;
      const double distance = (look.at.colwise() - from).colwise().norm().maxCoeff(&farthest);
      return {isChosen(look.candidate[farthest]) ? 0.0 : distance, look.candidate[farthest]};
    }
    const Planes planes = planesOf(hull);
    Eigen::Index face = 0;
    Eigen::Index farthest = 0;
    const double distance = (planes.normals.lazyProduct(look.at).colwise() - planes.offsets).maxCoeff(&face, &farthest);
    return {std::max(0.0, distance), look.candidate[farthest]};
  }

  [[nodiscard]] bool isChosen(VertexIndex candidate) const {
    return std::any_of(chosen_.begin(), chosen_.end(), [&](const Chosen& c) { return c.candidate == candidate; });
  }

  /// Sets the direction of each point's push: outward in the bind pose, of about unit length. Equal pushes of all
  /// points stretch the part by the same length along each of its principal axes, so no face loses what another one
  /// gains.
  void findDirections() {
    Vec3 mean = Vec3::Zero();
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      mean += bindPositionOf(point(i)) / countOf(candidates_);
    }
    Mat3 spread = Mat3::Zero();
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      const Vec3 offset = bindPositionOf(point(i)) - mean;
      spread += offset * offset.transpose();
    }
    axes_ = symmetricAxes(spread).vectors;
    box_ = Aabb();
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      box_.extend(axes_.transpose() * bindPositionOf(point(i)));
    }
    for (Chosen& c : chosen_) c.direction = directionOf(c.candidate);
  }

  [[nodiscard]] Vec3 directionOf(VertexIndex candidate) const {
    const Vec3 reach = (0.5 * (box_.max - box_.min)).cwiseMax(1e-3 * box_.diagonal());
    return axes_ * (axes_.transpose() * bindPositionOf(point(candidate)) - box_.center()).cwiseQuotient(reach);
  }

  /// Adds the points that protrude in one pose, farthest first. @return whether nothing protruded at the start
  bool takeOutside(int pose, std::size_t atMost) {
    bool held = true;
    for (auto [distance, candidate] = farthestOut(pose); distance > kHeld * size_ && chosen_.size() < atMost;
         std::tie(distance, candidate) = farthestOut(pose)) {
      held = false;
      // A point that was already chosen has been pushed the wrong way.
      const auto known = std::find_if(chosen_.begin(), chosen_.end(),
                                      [c = candidate](const Chosen& chosen) { return chosen.candidate == c; });
      if (known != chosen_.end()) {
        known->push.setZero();
        return false;
      }
      take(candidate);
      chosen_.back().direction = directionOf(candidate);
    }
    return held;
  }

  /// Pushes points until nothing protrudes in one pose. The shortest push is along the normal of the face from which a
  /// point protrudes. But if two faces meet at a sharp edge, one loses what the other gains, and only pushes outward
  /// converge.
  /// @param outward  share of the outward direction in a push, 0 to 1
  /// @return whether nothing protruded at the start
  bool holdIn(int pose, double outward) {
    const LookAt& look = lookAt_[pose];
    std::vector<Mat3> turns;
    turns.reserve(chosen_.size());
    for (const Chosen& c : chosen_) turns.push_back(turnOf(point(c.candidate), sampled_.pose(pose)));
    std::vector<Vec3> moves(chosen_.size());
    for (int push = 0; push < kPushes; ++push) {
      if (!(longestPush() <= kFarthestLift * size_)) return false;
      const ConvexHull hull = convexHull(chosenPositions(sampled_, pose));
      if (hull.degenerate()) return convexHull(positions(sampled_, pose)).degenerate();  // a plane covers no volume
      const Planes planes = planesOf(hull);
      const Eigen::MatrixXd above = planes.normals.lazyProduct(look.at).colwise() - planes.offsets;
      if (above.maxCoeff() <= kHeld * size_) return push == 0;

      // For each protruding point, move the corners of the face below it outward, the nearest ones most, minus what
      // earlier points have moved them already.
      std::fill(moves.begin(), moves.end(), Vec3::Zero());
      for (Eigen::Index i = 0; i < above.cols(); ++i) {
        Eigen::Index face = 0;
        const double distance = above.col(i).maxCoeff(&face);
        if (distance <= 0.0) continue;
        const Triangle& t = hull.triangles[face];
        const Vec3 normal = planes.normals.row(face).transpose();
        Vec3 gains = sharesOf(look.at.col(i), hull, t);
        double missing = (1.0 + kMore) * distance;
        for (int k = 0; k < 3; ++k) missing -= gains[k] * normal.dot(moves[chosenOf(hull, t, k)]);
        if (missing <= 0.0) continue;
        std::array<Vec3, 3> along;
        for (int k = 0; k < 3; ++k) {
          const std::size_t c = chosenOf(hull, t, k);
          const Vec3 d = turns[c] * chosen_[c].direction;
          along[k] = outward * d + (1.0 - outward) * normal;
          gains[k] *= std::max(kSteepest, normal.dot(along[k]));
        }
        for (int k = 0; k < 3; ++k) {
          moves[chosenOf(hull, t, k)] += missing * gains[k] / gains.squaredNorm() * along[k];
        }
      }
      for (std::size_t c = 0; c < chosen_.size(); ++c) {
        chosen_[c].push += turns[c].transpose() * moves[c] * (3.0 / turns[c].squaredNorm());
      }
    }
    return false;
  }

  [[nodiscard]] static std::size_t chosenOf(const ConvexHull& hull, const Triangle& t, int corner) {
    return hull.pointOfVertex[t[corner]];
  }

  /// Barycentric coordinates of the projection of a point onto a triangle; negative ones are clamped to 0.
  [[nodiscard]] static Vec3 sharesOf(const Vec3& p, const ConvexHull& hull, const Triangle& t) {
    const Vec3& a = hull.vertices[t[0]];
    const Vec3& b = hull.vertices[t[1]];
    const Vec3& c = hull.vertices[t[2]];
    const Vec3 normal = (b - a).cross(c - a);
    const Vec3 areas((b - p).cross(c - p).dot(normal), (c - p).cross(a - p).dot(normal),
                     (a - p).cross(b - p).dot(normal));
    const Vec3 inside = areas.cwiseMax(0.0);
    return inside.sum() > 0.0 ? Vec3(inside / inside.sum()) : Vec3::Constant(1.0 / 3.0);
  }

  std::span<const PointIndex> candidates_;
  std::span<const LiftedPoint> lifted_;
  BonePoseView sampled_;
  std::vector<LookAt> lookAt_;  ///< for each sampled pose
  std::vector<Chosen> chosen_;
  Mat3 axes_ = Mat3::Identity();  ///< principal axes of the bind pose
  Aabb box_;                      ///< along these axes
  double size_ = 0.0;
  double shortfall_ = 0.0;
};

}  // namespace

HullCover coverExactly(const Decomposition& decomposition, std::span<const LiftedPoint> lifted) {
  HullCover cover;
  cover.points.resize(decomposition.parts.size());
  const std::vector<std::vector<PointIndex>> attached = attachedVerticesOf(decomposition, lifted);
  for (std::size_t i = 0; i < cover.points.size(); ++i) {
    for (const PointIndex p : hullCandidates(decomposition, decomposition.parts[i], lifted, attached[i])) {
      cover.points[i].push_back({p, Vec3::Zero()});
    }
  }
  return cover;
}

Result<HullCover> chooseCover(const Decomposition& decomposition, std::span<const LiftedPoint> lifted,
                              BonePoseView sampled, BonePoseView heldOut, const CoverSettings& settings) {
  LORICA_CHECK(sampled.poseCount() > 0, "choosing a hull cover needs at least one sampled pose");
  if (!(settings.tolerance >= 0.0) || !std::isfinite(settings.tolerance)) {
    return invalidArgument("the cover tolerance is {} m, expected 0 or more", settings.tolerance);
  }
  if (settings.maxHullVertices != 0 && settings.maxHullVertices < 4) {
    return invalidArgument("the maximum number of hull vertices is {}, expected 4 or more", settings.maxHullVertices);
  }
  HullCover cover = coverExactly(decomposition, lifted);
  cover.tolerance = settings.tolerance;
  cover.maxHullVertices = settings.maxHullVertices;
  if (settings.tolerance == 0.0 && settings.maxHullVertices == 0) return cover;
  cover.sampledPoses = sampled.poseCount();
  cover.heldOutPoses = heldOut.poseCount();

  const std::size_t partCount = cover.points.size();
  const std::size_t atMost =
      settings.maxHullVertices == 0 ? std::size_t(-1) : static_cast<std::size_t>(settings.maxHullVertices);
  struct Outcome {
    double growth = 0.0, shortfall = 0.0, heldOut = 0.0;
    bool held = true;
  };
  std::vector<Outcome> outcomes(partCount);
  const bool finished = inParallel(partCount, settings.threads, settings.progress, [&](std::size_t i) {
    std::vector<PointIndex> candidates;
    candidates.reserve(cover.points[i].size());
    for (const CoverPoint& p : cover.points[i]) candidates.push_back(p.point);
    if (candidates.size() > 4) {
      PartCover part(candidates, lifted, sampled);
      part.choose(settings.tolerance, atMost);
      outcomes[i].held = part.grow(atMost);
      outcomes[i].shortfall = part.shortfall();
      outcomes[i].growth = part.longestPush();
      if (outcomes[i].held) outcomes[i].heldOut = part.farthestOut(heldOut);
      cover.points[i] = part.points();
    }
  });
  if (!finished) return cancelled();
  for (std::size_t i = 0; i < partCount; ++i) {
    if (!outcomes[i].held) {
      return invalidArgument("part {}: {} points cannot cover the body in all {} sampled poses; allow more vertices{}",
                             i, cover.points[i].size(), sampled.poseCount(),
                             settings.tolerance > 0.0 ? " or reduce the tolerance" : "");
    }
    cover.growth = std::max(cover.growth, outcomes[i].growth);
    cover.sampledShortfall = std::max(cover.sampledShortfall, outcomes[i].shortfall);
    cover.heldOutShortfall = std::max(cover.heldOutShortfall, outcomes[i].heldOut);
  }
  return cover;
}

LiftedPoint pushed(LiftedPoint point, const Vec3& outward) {
  for (LiftedTerm& t : point) t.moment += t.weight * outward;
  return point;
}

}  // namespace lorica
