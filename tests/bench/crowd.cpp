// Cost of a frame of a crowd: hulls of all avatars, and contacts between them. CSV on standard output.

#include "collision/live/choose_cover.h"
#include "collision/live/live_body.h"
#include "collision/world/body_contacts.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/bench/measure.h"
#include "tests/bench/walker.h"

#include <fmt/format.h>
#include <xxhash.h>
#include <CLI/CLI.hpp>

#include <cmath>
#include <memory>

namespace lorica::bench {
namespace {

struct Options {
  int parts = 16;
  int vertices = 64;
  int frames = 60;
  double spacing = 1.0;  // [m]
  std::vector<std::size_t> avatars = {1, 10, 100, 1000};
};

using BonePoses = std::vector<std::vector<Affine3>>;  // worldFromModel of each frame

BonePoses posesOf(const Character& character, const SkeletalMotion& motion) {
  BonePoses poses;
  for (int frame = 0; frame < motion.frameCount(); ++frame) poses.push_back(bonesOf(character, motion.pose(frame)));
  return poses;
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
      const double begin = cpuSeconds();
      crowd.bodies[a].update(matrices);
      hullsUs += 1e6 * (cpuSeconds() - begin);
    }
    const double begin = cpuSeconds();
    const std::span<const BodyContact> found = query.find(crowd.views, 1.0 / 30.0);
    if (frame > 0) {  // the first frame builds the hulls
      contacts.push_back(1e6 * (cpuSeconds() - begin));
      hulls.push_back(hullsUs);
    }
    row.contacts += static_cast<double>(found.size()) / options.frames;
    for (const LiveBody& body : crowd.bodies) row.hash = hashOfHulls(body, row.hash);
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

int run(const Options& options) {
  const Character character = makeMannequin();
  std::vector<BonePoses> motions;
  std::vector<Affine3> sampled;
  for (const SkeletalMotion& motion : syntheticMotions(character)) {
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
  measureCrowds(BodyPlan::create(*decomposition, character, *cover).value(), motions, options);
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
  app.add_option("--spacing", options.spacing, "Metres between neighbours")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  return lorica::bench::run(options);
}
