// Cost of a frame of a live body by stage, compared with the straightforward method in the same run: CSV on standard
// output.

#include "acd/transfer.h"
#include "capture/files/joint_csv.h"
#include "capture/retarget/retarget.h"
#include "collision/live/choose_cover.h"
#include "collision/live/lifted_part.h"
#include "collision/live/live_body.h"
#include "collision/live/rigid_fit.h"
#include "collision/world/self_contact.h"
#include "geometry/clock.h"
#include "session/pose_source.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/bench/measure.h"
#include "tests/bench/walker.h"

#include <LinearMath/btConvexHullComputer.h>
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <xxhash.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <optional>

namespace lorica::bench {
namespace {

constexpr std::size_t kReferenceStride = 40;  // the slow reference is timed on every n-th frame only

struct Options {
  int parts = 16;
  int repeats = 5;
};

/// Bone matrices of a character in each frame.
struct Motion {
  std::string name;
  std::vector<std::vector<Affine3>> worldFromModel;
};

/// A recording at 60 Hz: its frames, and interpolated poses halfway between them.
Motion poseAt60Hz(const Character& character, std::string_view which) {
  const std::vector<SkeletonFrame> frames = shippedFrames(which);
  Result<Retargeter> retargeter = Retargeter::create(character.skeleton);
  LORICA_CHECK(retargeter.ok(), "the mannequin is humanoid");
  Motion motion{std::string(which), {}};
  Pose pose = restPose(character.skeleton);
  Pose before;
  for (const SkeletonFrame& frame : frames) {
    retargeter->apply(frame, pose);
    if (!before.empty()) {
      Pose between = pose;
      for (std::size_t j = 0; j < pose.size(); ++j) {
        between[j].translation = 0.5 * (before[j].translation + pose[j].translation);
        between[j].rotation = before[j].rotation.slerp(0.5, pose[j].rotation);
      }
      motion.worldFromModel.push_back(bonesOf(character, between));
    }
    motion.worldFromModel.push_back(bonesOf(character, pose));
    before = pose;
  }
  return motion;
}

/// The same motions as a camera sees them: bodies move farther from frame to frame.
std::vector<Motion> at30Hz(std::span<const Motion> motions) {
  std::vector<Motion> slow(motions.begin(), motions.end());
  for (Motion& motion : slow) {
    std::vector<std::vector<Affine3>>& frames = motion.worldFromModel;
    for (std::size_t f = 0; 2 * f < frames.size(); ++f) frames[f] = frames[2 * f];
    frames.resize((frames.size() + 1) / 2);
  }
  return slow;
}

/// Times of the frames of all motions [us]. The minimum of the repeats of each frame counts, to exclude other load of
/// the machine.
struct FrameTimes {
  std::vector<double> us, cpuUs;
  std::uint64_t hash = 0;  ///< of the results of the frames

  [[nodiscard]] double median() const { return medianOf(us); }
  [[nodiscard]] double cpuMedian() const { return medianOf(cpuUs); }
  [[nodiscard]] double worst() const { return *std::max_element(us.begin(), us.end()); }
};

/// @param stride  every n-th frame is timed
/// @param start   called before each pass over a motion
/// @param frame   does the work of one frame; timed
/// @param hash    of the frame's result
/// @param before  prepares the frame; not timed
FrameTimes timeFrames(std::span<const Motion> motions, int repeats, std::size_t stride,
                      const std::function<void()>& start, const std::function<void(std::span<const Affine3>)>& frame,
                      const std::function<std::uint64_t(std::uint64_t)>& hash,
                      const std::function<void(std::span<const Affine3>)>& before = nullptr) {
  FrameTimes times;
  std::size_t first = 0;
  for (const Motion& motion : motions) {
    const std::size_t count = motion.worldFromModel.size();
    for (std::vector<double>* column : {&times.us, &times.cpuUs}) {
      column->resize(first + (count + stride - 1) / stride, std::numeric_limits<double>::infinity());
    }
    for (int repeat = 0; repeat < repeats; ++repeat) {
      start();
      if (before) before(motion.worldFromModel.front());
      frame(motion.worldFromModel.front());  // the first one builds
      for (std::size_t f = 0; f < count; f += stride) {
        if (before) before(motion.worldFromModel[f]);
        const double begin = now();
        const double cpuBegin = threadSeconds();
        frame(motion.worldFromModel[f]);
        const double cpuUs = 1e6 * (threadSeconds() - cpuBegin);
        const double us = 1e6 * (now() - begin);
        const std::size_t at = first + f / stride;
        times.us[at] = std::min(times.us[at], us);
        times.cpuUs[at] = std::min(times.cpuUs[at], cpuUs);
        if (repeat == 0) times.hash = hash(times.hash);
      }
    }
    first = times.us.size();
  }
  return times;
}

void row(const std::string& what, const FrameTimes& times, const FrameTimes& reference, const std::string& beside) {
  fmt::print("{},{:.2f},{:.2f},{:.2f},{},{:.2f},{:.2f},{:.1f},{:016x}\n", csvField(what), times.median(),
             times.cpuMedian(), times.worst(), csvField(beside), reference.median(), reference.cpuMedian(),
             reference.cpuMedian() / times.cpuMedian(), times.hash);
  std::fflush(stdout);
}

double volumeOf(const LiveBody& body) {
  double sum = 0.0;
  for (const LivePart& part : body.parts()) sum += part.shape.volume;
  return sum;
}

/// Poses of all motions in turn, each distant from the previous one.
Motion jumpsBetween(std::span<const Motion> motions) {
  Motion jumps{"jumps", {}};
  for (std::size_t i = 0; i < 400; ++i) {
    const auto& poses = motions[i % motions.size()].worldFromModel;
    jumps.worldFromModel.push_back(poses[i * 97 % poses.size()]);
  }
  return jumps;
}

/// Prints the memory that bodies of a plan allocate, and how much of it is resident after a motion.
void printMemory(const std::shared_ptr<const BodyPlan>& plan, const Motion& motion) {
  constexpr std::size_t kBodies = 32;
  const double before = residentBytes();
  std::vector<LiveBody> bodies;
  bodies.reserve(kBodies);
  for (std::size_t i = 0; i < kBodies; ++i) {
    bodies.emplace_back(plan);
    for (std::size_t f = 0; f < motion.worldFromModel.size(); f += 10) bodies.back().update(motion.worldFromModel[f]);
  }
  const double touched = (residentBytes() - before) / kBodies;
  fmt::print("# a body allocates {:.3f} MB and uses {:.3f} MB of it; all share {:.3f} MB in addition to the file\n",
             1e-6 * static_cast<double>(bodies.front().memory()), 1e-6 * touched,
             1e-6 * static_cast<double>(plan->memory()));
}

/// The table of the stages.
void measureStages(const Character& character, const Decomposition& decomposition, std::span<const Motion> motions,
                   int repeats) {
  const auto none = [] {};
  const auto noHash = [](std::uint64_t h) { return h; };
  std::vector<Vec3> points(static_cast<std::size_t>(decomposition.pointCount()));
  const auto posed = std::span(points).first(character.mesh.vertices.size());
  const auto skinAll = [&](std::span<const Affine3> matrices) {
    skinLinearBlend(character, matrices, posed);
    transfer(decomposition, posed, points);
  };
  const FrameTimes skinning = timeFrames(motions, repeats, 1, none, skinAll, noHash);

  std::vector<LiftedPart> lifted;
  std::vector<LiftedPart::TakenPose> taken;
  std::vector<std::vector<PointRow>> rows;
  const std::vector<LiftedPoint> all = liftPoints(character, decomposition);
  std::size_t candidateCount = 0;
  for (const Part& part : decomposition.parts) {
    std::vector<LiftedPoint> own;
    for (const PointIndex p : hullCandidates(decomposition, part, all)) own.push_back(all[p]);
    candidateCount += own.size();
    lifted.emplace_back(own);
    taken.push_back(lifted.back().noPose());
    rows.emplace_back(lifted.back().rowCount());
  }
  std::vector<Isometry3> positions(lifted.size(), Isometry3::Identity());
  std::vector<Mat3> covariances(lifted.size());
  std::vector<Mat3> rotations(lifted.size(), Mat3::Identity());
  const auto position = [&](std::span<const Affine3> matrices) {
    for (std::size_t i = 0; i < lifted.size(); ++i) {
      const LiftedPart::Moments moments = lifted[i].momentsOf(matrices);
      positions[i].translation() = moments.mean;
      covariances[i] = moments.covariance;
    }
    fitRotations(covariances, rotations);
    for (std::size_t i = 0; i < lifted.size(); ++i) positions[i].linear() = rotations[i];
  };
  row("rigid motions of all parts", timeFrames(motions, repeats, 1, none, position, noHash), skinning,
      "skinning the mesh and its cut points");
  std::map<const Affine3*, std::vector<Isometry3>> positionsOf;
  for (const Motion& motion : motions) {
    for (const std::vector<Affine3>& matrices : motion.worldFromModel) {
      position(matrices);
      positionsOf[matrices.data()] = positions;
    }
  }
  const auto evaluate = [&](std::span<const Affine3> matrices) {
    const std::vector<Isometry3>& now = positionsOf.at(matrices.data());
    for (std::size_t i = 0; i < lifted.size(); ++i) {
      lifted[i].take(matrices, now[i], 0x1p-22, taken[i]);
      (void)lifted[i].evaluate(taken[i], rows[i]);
    }
  };
  const auto hashRows = [&](std::uint64_t h) {
    for (std::size_t i = 0; i < lifted.size(); ++i) {
      h = XXH3_64bits_withSeed(rows[i].data(), lifted[i].pointCount() * sizeof(PointRow), h);
    }
    return h;
  };
  const FrameTimes candidates = timeFrames(motions, repeats, 1, none, evaluate, hashRows);
  row(fmt::format("all {} candidates", candidateCount), candidates, skinning, "skinning the mesh and its cut points");

  const auto plan = BodyPlan::create(decomposition, character).value();
  std::optional<LiveBody> body;
  const auto startBody = [&] { body.emplace(plan); };
  const auto hashBody = [&](std::uint64_t h) { return hashOfHulls(*body, h); };
  const auto startSupport = [&] { body.emplace(plan, LiveDetail::kSupport); };
  const auto update = [&](std::span<const Affine3> matrices) { body->update(matrices); };
  row("support only, exact", timeFrames(motions, repeats, 1, startSupport, update, noHash), skinning,
      "skinning the mesh and its cut points");
  const FrameTimes hulls = timeFrames(motions, repeats, 1, startBody, update, hashBody);

  btConvexHullComputer computer;
  const auto bulletHulls = [&](std::span<const Affine3> matrices) {
    evaluate(matrices);
    for (std::size_t i = 0; i < lifted.size(); ++i) {
      computer.compute(&rows[i].front().x, sizeof(PointRow), static_cast<int>(lifted[i].pointCount()), 0.0f, 0.0f);
    }
  };
  const FrameTimes bullet = timeFrames(motions, 1, kReferenceStride, none, bulletHulls, noHash);
  row("hulls with faces", hulls, bullet, "btConvexHullComputer on the same points");
  const std::vector<Motion> slow = at30Hz(motions);
  for (const Motion& motion : slow) {
    row("hulls with faces at 30 Hz: " + motion.name, timeFrames({&motion, 1}, repeats, 1, startBody, update, hashBody),
        bullet, "btConvexHullComputer on the same points");
  }

  const std::vector<Motion> jumps = {jumpsBetween(motions)};
  row("hulls with faces after a jump", timeFrames(jumps, repeats, 1, startBody, update, hashBody), bullet,
      "btConvexHullComputer on the same points");

  SelfContactQuery query(LiveBody(plan), character.mesh.vertices);
  std::span<const SelfContact> found;
  const auto ask = [&](std::span<const Affine3> /*matrices*/) { found = query.find(body->parts()); };
  const auto hashFound = [&](std::uint64_t h) {
    for (const SelfContact& contact : found) h = XXH3_64bits_withSeed(&contact.depth, sizeof(contact.depth), h);
    return h;
  };
  row("self-contacts", timeFrames(motions, repeats, 1, startBody, ask, hashFound, update), hulls, "hulls with faces");

  fmt::print("# {} vertices, {} joints, {} parts; {} frames at 60 Hz\n", character.mesh.vertices.size(),
             character.skeleton.jointCount(), decomposition.parts.size(), skinning.us.size());
  printMemory(plan, motions.front());

  // Few points per part, chosen in poses of the motions.
  std::vector<Affine3> sampled;
  for (const Motion& motion : motions) {
    for (std::size_t f = 0; f < motion.worldFromModel.size(); f += 40) {
      sampled.insert(sampled.end(), motion.worldFromModel[f].begin(), motion.worldFromModel[f].end());
    }
  }
  const BonePoseView poses{sampled, character.skeleton.jointCount()};
  for (const int vertices : {64, 32, 16}) {
    const double begin = now();
    const Result<HullCover> cover = chooseCover(decomposition, all, poses, {}, {.maxHullVertices = vertices});
    LORICA_CHECK(cover.ok(), "a cover with this number of points must exist");
    fmt::print(
        "# cover of {} points per part, from {} poses in {:.1f} s: {:.1f} mm protruded, enlarged by up to {:.1f} mm\n",
        vertices, poses.poseCount(), now() - begin, 1e3 * cover->sampledShortfall, 1e3 * cover->growth);
    const auto fewer = BodyPlan::create(decomposition, character, *cover).value();
    const auto startCovered = [&] { body.emplace(fewer); };
    LiveBody covered(fewer);
    LiveBody exact(plan);
    double volume = 0.0;
    for (int p = 0; p < poses.poseCount(); ++p) {
      covered.update(poses.pose(p));
      exact.update(poses.pose(p));
      volume += volumeOf(covered) / volumeOf(exact) / poses.poseCount();
    }
    fmt::print("# its hulls are {:.3f} times as large as the exact ones\n", volume);
    row(fmt::format("hulls with faces of {} points, with cover", vertices),
        timeFrames(motions, repeats, 1, startCovered, update, hashBody), bullet, "btConvexHullComputer on all points");
    if (vertices != 64) continue;
    row("hulls with faces of 64 points at 30 Hz, with cover",
        timeFrames(slow, repeats, 1, startCovered, update, hashBody), bullet, "btConvexHullComputer on all points");
    printMemory(fewer, motions.front());
    const auto startPoints = [&] { body.emplace(fewer, LiveDetail::kSupport); };
    row("support only of 64 points, with cover", timeFrames(motions, repeats, 1, startPoints, update, noHash), bullet,
        "btConvexHullComputer on all points");
    std::vector<LiveBody> crowd(100, LiveBody(fewer));
    const auto updateCrowd = [&](std::span<const Affine3> matrices) {
      for (LiveBody& one : crowd) one.update(matrices);
    };
    row("a hundred characters of 64 points per hull", timeFrames(motions.first(1), 1, 1, none, updateCrowd, noHash),
        bullet, "btConvexHullComputer on all points of one");
  }
}

int run(const Options& options) {
  const Character character = makeMannequin();
  std::vector<Motion> motions;
  motions.reserve(kShippedMotions.size());
  for (const std::string_view name : kShippedMotions) {
    motions.push_back(poseAt60Hz(character, name));
  }
  const tbb::global_control oneCore(tbb::global_control::max_allowed_parallelism, 1);
  fmt::print("what,median_us,cpu_median_us,worst_us,beside,beside_median_us,beside_cpu_median_us,cpu_ratio,hash\n");
  const Result<Decomposition> decomposition = decomposeMannequin(character, options.parts);
  if (!decomposition) return fail(decomposition.error());
  measureStages(character, *decomposition, motions, options.repeats);
  return 0;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  lorica::bench::Options options;
  CLI::App app("Cost of a frame of a live body, compared with the straightforward method in the same run.");
  app.add_option("--parts", options.parts, "Parts of the mannequin")->check(CLI::PositiveNumber);
  app.add_option("--repeats", options.repeats, "Passes over each motion; the minimum time of each frame counts")
      ->check(CLI::PositiveNumber);
  lorica::bench::addInstructions(app);
  CLI11_PARSE(app, argc, argv);
  return lorica::bench::run(options);
}
