// Cost of updating the hulls of a body's parts by repairing the faces of the last frame, compared with building them
// from the same points in the same run: CSV on standard output. Times are CPU microseconds for all parts in one frame.

#include "collision/live/moving_hull.h"
#include "acd/decompose.h"
#include "acd/transfer.h"
#include "bench/measure.h"
#include "capture/synthetic/synthetic_motion.h"
#include "collision/live/lifted_point.h"
#include "prepare/keyframes.h"
#include "session/pose_source.h"
#include "skinning/mannequin/mannequin.h"

#include <LinearMath/btConvexHullComputer.h>
#include <fmt/format.h>
#include <xxhash.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>

namespace lorica::bench {
namespace {

struct Options {
  int parts = 16;
  int repeats = 3;
  int pointsPerPart = 0;  // 0 = all
  int onlyMotion = -1;
  bool references = true;
  double ticksPerMetre = 1e6;
  std::vector<int> every = {1, 2, 4, 20};
};

double cpuMicroseconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

using Rows = std::vector<PointRow>;
using Frame = std::vector<Rows>;  // one entry per part

/// The points of each part in each frame, relative to their mean, in ticks.
std::vector<Frame> ticksOf(const Decomposition& decomposition, std::span<const std::vector<PointIndex>> chosen,
                           std::span<const std::vector<Vec3>> poses, double ticksPerMetre) {
  std::vector<Frame> frames;
  frames.reserve(poses.size());
  std::vector<Vec3> points(static_cast<std::size_t>(decomposition.pointCount()));
  for (const std::vector<Vec3>& posed : poses) {
    transfer(decomposition, posed, points);
    Frame& frame = frames.emplace_back();
    frame.reserve(chosen.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      Vec3 mean = Vec3::Zero();
      for (const PointIndex p : chosen[i]) mean += points[p];
      mean /= static_cast<double>(chosen[i].size());
      Rows& rows = frame.emplace_back();
      rows.reserve(chosen[i].size());
      for (const PointIndex p : chosen[i]) {
        const Vec3 q = (points[p] - mean) * ticksPerMetre;
        const Vec3f f = q.array().round().min(kMaxTicks).max(-kMaxTicks).matrix().cast<float>();
        rows.push_back({f.x(), f.y(), f.z(), 0.0F});
      }
    }
  }
  return frames;
}

/// All frames of a motion at 30 Hz, and interpolated poses halfway between them.
std::vector<std::vector<Vec3>> posesAt60Hz(const Character& character, const SkeletalMotion& motion) {
  const std::vector<Vec3> all = poseAllFrames(character, motion);
  const std::size_t vertexCount = character.mesh.vertices.size();
  std::vector<std::vector<Vec3>> poses;
  poses.reserve(2 * motion.times.size());
  for (std::size_t f = 0; f < motion.times.size(); ++f) {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(f * vertexCount);
    std::vector<Vec3> pose(begin, begin + static_cast<std::ptrdiff_t>(vertexCount));
    if (f > 0) {
      std::vector<Vec3> between = pose;
      for (std::size_t v = 0; v < vertexCount; ++v) between[v] = 0.5 * (pose[v] + poses.back()[v]);
      poses.push_back(std::move(between));
    }
    poses.push_back(std::move(pose));
  }
  return poses;
}

/// The points of each part that can be on its hull, or a number of them at even intervals.
std::vector<std::vector<PointIndex>> choosePoints(const Character& character, const Decomposition& decomposition,
                                                  int max) {
  const std::vector<LiftedPoint> lifted = liftPoints(character, decomposition);
  std::vector<std::vector<PointIndex>> chosen;
  chosen.reserve(decomposition.parts.size());
  for (const Part& part : decomposition.parts) {
    std::vector<PointIndex>& own = chosen.emplace_back(hullCandidates(decomposition, part, lifted));
    if (max <= 0 || own.size() <= static_cast<std::size_t>(max)) continue;
    for (int i = 0; i < max; ++i) {
      own[i] = own[static_cast<std::size_t>(i) * own.size() / static_cast<std::size_t>(max)];
    }
    own.resize(max);
  }
  return chosen;
}

struct Summary {
  std::vector<double> us;
  std::uint64_t hash = 0;
  MovingHull::Counts sum;
  std::size_t vertices = 0;
};

Summary follow(std::span<const Frame> frames, int repeats) {
  Summary summary;
  summary.us.assign(frames.size() - 1, std::numeric_limits<double>::infinity());
  for (int repeat = 0; repeat < repeats; ++repeat) {
    std::vector<MovingHull> hulls;
    hulls.reserve(frames.front().size());
    for (const Rows& rows : frames.front()) {
      hulls.emplace_back(static_cast<int>(rows.size()));
      hulls.back().update(rows);
    }
    Frame now = frames.front();
    for (std::size_t f = 1; f < frames.size(); ++f) {
      now = frames[f];  // brings the points into the cache, as if they had just been posed
      const double begin = cpuMicroseconds();
      for (std::size_t i = 0; i < hulls.size(); ++i) hulls[i].update(now[i]);
      double& us = summary.us[f - 1];
      us = std::min(us, cpuMicroseconds() - begin);
      if (repeat > 0) continue;
      for (const MovingHull& hull : hulls) {
        summary.hash = XXH3_64bits_withSeed(hull.faces().data(), hull.faces().size_bytes(), summary.hash);
        summary.vertices += hull.vertices().size();
        summary.sum.turnedFaces += hull.counts().turnedFaces;
        summary.sum.flips += hull.counts().flips;
        summary.sum.deletions += hull.counts().deletions;
        summary.sum.insertions += hull.counts().insertions;
        summary.sum.failedCertificates += hull.counts().failedCertificates;
        summary.sum.rebuilds += hull.counts().rebuilds;
      }
    }
  }
  return summary;
}

/// Median time to build the hulls of a frame from scratch, over every tenth frame.
template <class Build>
double medianFromScratch(std::span<const Frame> frames, const Build& build) {
  std::vector<double> us;
  us.reserve(frames.size());
  for (std::size_t f = 0; f < frames.size(); f += 10) {
    double sum = 0.0;
    for (const Rows& rows : frames[f]) sum += build(rows);
    us.push_back(sum);
  }
  return medianOf(us);
}

double timeConvexHull(const Rows& rows) {
  std::vector<Vec3> points;
  points.reserve(rows.size());
  for (const PointRow& r : rows) points.emplace_back(r.x, r.y, r.z);
  const double begin = cpuMicroseconds();
  const ConvexHull hull = convexHull(points);
  const double us = cpuMicroseconds() - begin;
  LORICA_CHECK(!hull.degenerate(), "a limb is not flat");
  return us;
}

double timeBullet(const Rows& rows) {
  const double begin = cpuMicroseconds();
  btConvexHullComputer computer;
  computer.compute(&rows.front().x, sizeof(PointRow), static_cast<int>(rows.size()), 0.0F, 0.0F);
  const double us = cpuMicroseconds() - begin;
  LORICA_CHECK(computer.faces.size() > 3, "a limb is not flat");
  return us;
}

double timeNewBuild(const Rows& rows) {
  MovingHull hull(static_cast<int>(rows.size()));
  hull.update(Rows(rows.size()));  // all points equal: flat, but touches the memory
  const double begin = cpuMicroseconds();
  hull.update(rows);
  return cpuMicroseconds() - begin;
}

int run(const Options& options) {
  const Character character = makeMannequin();
  std::vector<SkeletalMotion> motions;
  motions.reserve(kSyntheticMotionCount);
  for (int m = 0; m < kSyntheticMotionCount; ++m) {
    motions.push_back(perform(character.skeleton, synthesizeMotion(static_cast<SyntheticMotion>(m))).value());
  }
  const Result<std::vector<Vec3>> keyframes = sampleKeyframes(character, motions, 12);
  if (!keyframes) return fail(keyframes.error());
  DecomposeSettings settings;
  settings.maxParts = options.parts;
  const Result<Decomposition> decomposition =
      decompose(character.mesh, {*keyframes, static_cast<int>(character.mesh.vertices.size())}, settings);
  if (!decomposition) return fail(decomposition.error());
  const std::vector<std::vector<PointIndex>> chosen = choosePoints(character, *decomposition, options.pointsPerPart);
  const std::size_t pointCount = std::accumulate(chosen.begin(), chosen.end(), std::size_t{0},
                                                 [](std::size_t n, const auto& own) { return n + own.size(); });
  fmt::print(
      "motion,hz,points,vertices,us_median,us_worst,us_convex_hull,us_bullet,us_own_build,turned,flips,deletions,"
      "insertions,failed_certificates,rebuilds,hash\n");
  for (int m = 0; m < kSyntheticMotionCount; ++m) {
    if (options.onlyMotion >= 0 && m != options.onlyMotion) continue;
    const std::vector<Frame> frames =
        ticksOf(*decomposition, chosen, posesAt60Hz(character, motions[m]), options.ticksPerMetre);
    std::array<double, 3> scratch{};
    if (options.references) {
      scratch = {medianFromScratch(frames, timeConvexHull), medianFromScratch(frames, timeBullet),
                 medianFromScratch(frames, timeNewBuild)};
    }
    for (const int every : options.every) {
      std::vector<Frame> taken;
      taken.reserve(frames.size());
      for (std::size_t f = 0; f < frames.size(); f += static_cast<std::size_t>(every)) taken.push_back(frames[f]);
      const Summary s = follow(taken, options.repeats);
      const auto n = static_cast<double>(s.us.size());
      fmt::print(
          "{},{},{},{:.0f},{:.1f},{:.1f},{:.0f},{:.0f},{:.0f},{:.1f},{:.1f},{:.2f},{:.2f},{:.1f},{:.3f},{:016x}\n",
          nameOf(static_cast<SyntheticMotion>(m)), 60 / every, pointCount, static_cast<double>(s.vertices) / n,
          medianOf(s.us), *std::max_element(s.us.begin(), s.us.end()), scratch[0], scratch[1], scratch[2],
          s.sum.turnedFaces / n, s.sum.flips / n, s.sum.deletions / n, s.sum.insertions / n,
          s.sum.failedCertificates / n, s.sum.rebuilds / n, s.hash);
      std::fflush(stdout);
    }
  }
  return 0;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  lorica::bench::Options options;
  CLI::App app("Measures hulls of moving points on the built-in character and motions; counts are means per frame.");
  app.add_option("--parts", options.parts, "Parts of the decomposition [default: 16]")->check(CLI::Range(1, 128));
  app.add_option("--points", options.pointsPerPart, "Maximum number of points per part [default: all]")
      ->check(CLI::Range(4, 100000));
  app.add_option("--motion", options.onlyMotion, "Number of the only motion to measure [default: all]")
      ->check(CLI::Range(0, lorica::kSyntheticMotionCount - 1));
  app.add_option("--repeats", options.repeats, "Repeats; the minimum time of each frame counts [default: 3]")
      ->check(CLI::Range(1, 1000));
  app.add_flag("!--no-references", options.references, "Do not measure building from scratch");
  app.add_option("--ticks", options.ticksPerMetre, "Grid steps per metre [default: 1,000,000]")
      ->check(CLI::Range(1e3, 1e7));
  app.add_option("--every", options.every, "Use every n-th frame of 60 per second [default: 1,2,4,20]")
      ->delimiter(',')
      ->check(CLI::Range(1, 60));
  CLI11_PARSE(app, argc, argv);
  return lorica::bench::run(options);
}
