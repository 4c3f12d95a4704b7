// Cost of a frame of a crowd: hulls of all avatars, and contacts between them; with --props a whole session of them
// among props. CSV on standard output.

#include "bench/measure.h"
#include "bench/walker.h"
#include "collision/live/choose_cover.h"
#include "collision/live/live_body.h"
#include "collision/world/body_contacts.h"
#include "geometry/triangle_tree.h"
#include "session/session.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"

#include <fmt/format.h>
#include <xxhash.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <memory>

namespace lorica::bench {
namespace {

struct Options {
  int parts = 16;
  int vertices = 64;
  int frames = 60;
  int repeats = 1;
  double spacing = 1.0;  // [m]
  bool truth = false;
  int props = 0;  // 0 = no session
  std::vector<std::size_t> avatars = {1, 10, 100, 1000};
};

using BonePoses = std::vector<std::vector<Affine3>>;  // worldFromModel of each frame

BonePoses posesOf(const Character& character, const SkeletalMotion& motion) {
  BonePoses poses;
  for (int frame = 0; frame < motion.frameCount(); ++frame) {
    std::vector<Affine3>& matrices = poses.emplace_back(motion.pose(frame).size());
    computeWorldFromJoint(character.skeleton, motion.pose(frame), matrices);
    computeWorldFromModel(character, matrices, matrices);
  }
  return poses;
}

double microsecondsOf(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

/// CPU time: other load of the machine does not count [us].
double cpuMicroseconds() {
  return microsecondsOf(CLOCK_PROCESS_CPUTIME_ID);
}

std::vector<Affine3> placed(const std::vector<Affine3>& matrices, const Isometry3& place) {
  std::vector<Affine3> moved;
  moved.reserve(matrices.size());
  for (const Affine3& matrix : matrices) moved.emplace_back(place * matrix);
  return moved;
}

/// Avatars of one kind in a square grid, out of step: each has another motion or begins it elsewhere.
struct Crowd {
  std::vector<LiveBody> bodies;
  std::vector<double> masses;
  std::vector<BodyInWorld> views;

  Crowd(const std::shared_ptr<const BodyPlan>& plan, std::size_t count)
      : bodies(count, LiveBody(plan)), masses(plan->decomposition().parts.size(), 1.0) {
    for (const LiveBody& body : bodies) views.push_back({body.parts(), masses});
  }
};

std::uint64_t hashOf(const LiveBody& body, std::uint64_t seed) {
  for (const LivePart& part : body.parts()) {
    seed = XXH3_64bits_withSeed(part.shape.vertices.data(), part.shape.vertices.size() * sizeof(Vec3), seed);
  }
  return seed;
}

struct Row {
  double hullsUs = 0.0, contactsUs = 0.0, contacts = 0.0, bytes = 0.0;
  std::uint64_t hash = 0;
};

Row measure(const std::shared_ptr<const BodyPlan>& plan, std::span<const BonePoses> motions, const Options& options,
            std::size_t count) {
  const double before = residentBytes();
  Crowd crowd(plan, count);
  BodyContactQuery query;
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  std::vector<double> hulls, contacts;
  Row row;
  for (int frame = 0; frame < options.frames; ++frame) {
    double hullsUs = 0.0;
    for (std::size_t a = 0; a < count; ++a) {
      const BonePoses& poses = motions[a % motions.size()];
      Isometry3 place = Isometry3::Identity();
      const std::size_t x = a % side;
      const std::size_t z = a / side;
      place.translation() = options.spacing * Vec3(static_cast<double>(x), 0.0, static_cast<double>(z));
      const std::vector<Affine3> matrices =
          placed(poses[(static_cast<std::size_t>(frame) + 37 * a) % poses.size()], place);
      const double begin = cpuMicroseconds();
      crowd.bodies[a].update(matrices);
      hullsUs += cpuMicroseconds() - begin;
    }
    const double begin = cpuMicroseconds();
    const std::span<const BodyContact> found = query.find(crowd.views, 1.0 / 30.0);
    if (frame > 0) {  // the first frame builds the hulls
      contacts.push_back(cpuMicroseconds() - begin);
      hulls.push_back(hullsUs);
    }
    row.contacts += static_cast<double>(found.size()) / options.frames;
    for (const LiveBody& body : crowd.bodies) row.hash = hashOf(body, row.hash);
    for (const BodyContact& c : found) row.hash = XXH3_64bits_withSeed(&c.depth, sizeof(c.depth), row.hash);
  }
  row.hullsUs = medianOf(hulls);
  row.contactsUs = medianOf(contacts);
  row.bytes = (residentBytes() - before) / static_cast<double>(count);
  return row;
}

void measureCrowds(const std::shared_ptr<const BodyPlan>& plan, std::span<const BonePoses> motions,
                   const Options& options) {
  fmt::print("avatars,hulls_cpu_us,contacts_cpu_us,contacts,kB_each,hash\n");
  std::vector<double> counts, times;
  for (const std::size_t count : options.avatars) {
    const Row row = measure(plan, motions, options, count);
    fmt::print("{},{:.1f},{:.1f},{:.1f},{:.0f},{:016x}\n", count, row.hullsUs, row.contactsUs, row.contacts,
               1e-3 * row.bytes, row.hash);
    std::fflush(stdout);
    counts.push_back(static_cast<double>(count));
    times.push_back(row.hullsUs + row.contactsUs);
  }
  if (counts.size() > 1) fmt::print("# scales with avatars to the power of {:.2f}\n", fittedExponent(counts, times));
}

/// A motion that repeats, from one of its frames on, at 30 Hz.
class Repeated final : public PoseSource {
 public:
  Repeated(const SkeletalMotion& motion, int begin) : motion_(motion), frame_(begin) {}
  Result<std::optional<double>> next(std::span<JointTransform> pose) override {
    const std::span<const JointTransform> now = motion_.pose(frame_++ % motion_.frameCount());
    std::copy(now.begin(), now.end(), pose.begin());
    return std::optional(static_cast<double>(shown_++) / 30.0);
  }

 private:
  const SkeletalMotion& motion_;
  int frame_, shown_ = 0;
};

/// Boxes and balls on the floor, scattered over a square.
World worldOf(int props, double side) {
  World world;
  for (int i = 0; i < props; ++i) {
    Prop prop;
    prop.shape = i % 2 == 0 ? PropShape::kBox : PropShape::kSphere;
    prop.halfExtents = Vec3::Constant(0.1);
    // A sequence that fills the square evenly, after Roberts 2018: the plastic number's powers.
    const double x = std::fmod(0.7548776662466927 * i, 1.0), z = std::fmod(0.5698402909980532 * i, 1.0);
    prop.worldFromProp.translation() = Vec3(side * x - 0.5, 0.1, side * z - 0.5);
    world.addProp(prop);
  }
  return world;
}

/// What a frame of a session takes [us].
struct FrameCost {
  double all = 0.0, cpu = 0.0;
  double physics = 0.0;  ///< with contacts between avatars, which are found meanwhile
};

/// A session of avatars in a square grid among props.
Session sessionOf(const SessionAvatar& kind, std::span<const SkeletalMotion> motions, const Options& options,
                  std::size_t count) {
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  Session session(worldOf(options.props, std::max(10.0, options.spacing * static_cast<double>(side))));
  for (std::size_t a = 0; a < count; ++a) {
    SessionAvatar avatar =
        kind.another(std::make_unique<Repeated>(motions[a % motions.size()], static_cast<int>(37 * a)));
    const std::size_t x = a % side;
    const std::size_t z = a / side;
    const Vec3 cell(static_cast<double>(x), 0.0, static_cast<double>(z));
    avatar.setPlace(Isometry3(Eigen::Translation3d(options.spacing * cell)));
    session.addAvatar(std::move(avatar));
  }
  return session;
}

void keepLeast(std::vector<double>& values, std::size_t i, double value) {
  if (i == values.size()) {
    values.push_back(value);
  } else {
    values[i] = std::min(values[i], value);
  }
}

FrameCost costOfFrame(Session& session) {
  const double cpuBegin = microsecondsOf(CLOCK_PROCESS_CPUTIME_ID), begin = microsecondsOf(CLOCK_MONOTONIC);
  (void)session.step();
  (void)session.avatarContacts();
  const double end = microsecondsOf(CLOCK_MONOTONIC);
  return {end - begin, microsecondsOf(CLOCK_PROCESS_CPUTIME_ID) - cpuBegin, session.times().physics};
}

/// Avatars among props: all stages of a session. Of each frame the quickest repeat counts.
void measureSessions(const Character& character, const Decomposition& decomposition, const HullCover& cover,
                     std::span<const SkeletalMotion> motions, const Options& options) {
  fmt::print("avatars,frame_us,frame_cpu_us,physics_us,prop_contacts,avatar_contacts,kB_each,hash\n");
  std::vector<double> counts, times;
  const SessionAvatar kind = SessionAvatar::create(character, decomposition, makeMotionPoseSource({}), cover).value();
  for (const std::size_t count : options.avatars) {
    std::vector<double> frames, cpu, physics;
    double touches = 0.0, meetings = 0.0, bytes = 0.0;
    std::uint64_t hash = 0;
    for (int repeat = 0; repeat < options.repeats; ++repeat) {
      const double before = residentBytes();
      Session session = sessionOf(kind, motions, options, count);
      touches = meetings = 0.0;
      (void)costOfFrame(session);  // builds the hulls
      for (std::size_t frame = 0; frame + 1 < static_cast<std::size_t>(options.frames); ++frame) {
        const FrameCost cost = costOfFrame(session);
        keepLeast(frames, frame, cost.all);
        keepLeast(cpu, frame, cost.cpu);
        keepLeast(physics, frame, cost.physics);
        touches += static_cast<double>(session.world().contacts().size()) / options.frames;
        meetings += static_cast<double>(session.avatarContacts().size()) / options.frames;
      }
      if (repeat == 0) bytes = residentBytes() - before;
      hash = session.hash();
    }
    counts.push_back(static_cast<double>(count));
    times.push_back(medianOf(cpu));
    fmt::print("{},{:.0f},{:.0f},{:.0f},{:.1f},{:.1f},{:.0f},{:016x}\n", count, medianOf(frames), times.back(),
               medianOf(physics), touches, meetings, 1e-3 * bytes / static_cast<double>(count), hash);
    std::fflush(stdout);
  }
  if (counts.size() > 1)
    fmt::print("# CPU time scales with avatars to the power of {:.2f}\n", fittedExponent(counts, times));
}

/// How near two meshes are to each other [m]: 0 if a vertex of one is inside the other; and how deep such a vertex is.
struct Nearness {
  double apart = std::numeric_limits<double>::infinity(), inside = 0.0;

  void look(std::span<const Vec3> points, const TriangleTree& other) {
    for (const Vec3& p : points) {
      const TriangleTree::Hit hit = other.nearest(p, std::max(0.1, apart), [](std::int32_t) { return true; });
      if (!std::isfinite(hit.distance)) continue;
      const bool within = other.windingNumber(p) > 0.5;
      apart = std::min(apart, within ? 0.0 : hit.distance);
      if (within) inside = std::max(inside, hit.distance);
    }
  }
};

/// Two performers who face each other, compared with their true meshes.
void measureTruth(const Character& character, const std::shared_ptr<const BodyPlan>& plan,
                  std::span<const BonePoses> motions, const Options& options) {
  fmt::print("metres,frames,meshes_touch,contacts,missed,missed_2cm,false,false_2cm,farthest_false_mm\n");
  const std::vector<Triangle>& triangles = character.mesh.triangles;
  for (const double metres : {0.3, 0.5, 0.7, 0.9}) {
    Crowd crowd(plan, 2);
    BodyContactQuery query;
    Isometry3 places[2] = {Isometry3::Identity(), Isometry3::Identity()};
    places[1].translation().z() = metres;
    places[1].linear() = Mat3(Eigen::AngleAxisd(std::acos(-1.0), Vec3::UnitY()));
    int frames = 0, touching = 0, found = 0, missed = 0, missed2 = 0, wrong = 0, wrong2 = 0;
    double farthest = 0.0;
    for (std::size_t m = 0; m < motions.size(); ++m) {
      for (int frame = 0; frame < options.frames; ++frame) {
        std::vector<Vec3> points[2];
        for (std::size_t a = 0; a < 2; ++a) {
          const BonePoses& poses = motions[(m + a) % motions.size()];
          const std::vector<Affine3> matrices =
              placed(poses[static_cast<std::size_t>(5 * frame) % poses.size()], places[a]);
          crowd.bodies[a].update(matrices);
          points[a].resize(character.mesh.vertices.size());
          skinLinearBlend(character, matrices, points[a]);
        }
        const bool contact = !query.find(crowd.views, 1.0 / 30.0).empty();
        Nearness nearness;
        nearness.look(points[0], TriangleTree(points[1], triangles));
        nearness.look(points[1], TriangleTree(points[0], triangles));
        ++frames;
        touching += nearness.apart == 0.0 ? 1 : 0;
        found += contact ? 1 : 0;
        missed += !contact && nearness.apart == 0.0 ? 1 : 0;
        missed2 += !contact && nearness.inside > 0.02 ? 1 : 0;
        if (!contact || nearness.apart == 0.0) continue;
        ++wrong;
        wrong2 += nearness.apart > 0.02 ? 1 : 0;
        farthest = std::max(farthest, nearness.apart);
      }
    }
    fmt::print("{},{},{},{},{},{},{},{},{:.1f}\n", metres, frames, touching, found, missed, missed2, wrong, wrong2,
               1e3 * farthest);
    std::fflush(stdout);
  }
}

int run(const Options& options) {
  const Character character = makeMannequin();
  std::vector<BonePoses> motions;
  std::vector<Affine3> sampled;
  const std::vector<SkeletalMotion> performed = syntheticMotions(character);
  for (const SkeletalMotion& motion : performed) {
    motions.push_back(posesOf(character, motion));
    for (std::size_t f = 0; f < motions.back().size(); f += 20) {
      sampled.insert(sampled.end(), motions.back()[f].begin(), motions.back()[f].end());
    }
  }
  const Result<Decomposition> decomposition = decomposeMannequin(character, options.parts);
  if (!decomposition) return fail(decomposition.error());
  const BonePoseView poses{sampled, character.skeleton.jointCount()};
  const Result<HullCover> cover = chooseCover(*decomposition, liftPoints(character, *decomposition), poses, {},
                                              {.maxHullVertices = options.vertices});
  if (!cover) return fail(cover.error());
  if (options.props > 0) {
    measureSessions(character, *decomposition, *cover, performed, options);
    return 0;
  }
  const auto plan = BodyPlan::create(*decomposition, character, *cover).value();
  if (options.truth) {
    measureTruth(character, plan, motions, options);
  } else {
    measureCrowds(plan, motions, options);
  }
  return 0;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  lorica::bench::Options options;
  CLI::App app("Cost of a frame of 1 to 1,000 avatars on one core.");
  app.add_option("--parts", options.parts, "Parts of the mannequin")->check(CLI::PositiveNumber);
  app.add_option("--vertices", options.vertices, "Points of each hull")->check(CLI::PositiveNumber);
  app.add_option("--frames", options.frames, "Frames at 30 Hz; the median counts")->check(CLI::PositiveNumber);
  app.add_option("--avatars", options.avatars, "How many, one row each")->delimiter(',')->check(CLI::Range(1, 1750));
  app.add_option("--repeats", options.repeats, "With --props: the quickest of as many runs counts, frame by frame")
      ->check(CLI::PositiveNumber);
  app.add_option("--spacing", options.spacing, "Metres between neighbours")->check(CLI::PositiveNumber);
  app.add_option("--props", options.props, "Measure a session with this many props instead")
      ->check(CLI::Range(1, lorica::World::kMaxProps));
  app.add_flag("--truth", options.truth, "Compare contacts of two performers with their true meshes instead");
  CLI11_PARSE(app, argc, argv);
  return lorica::bench::run(options);
}
