// A file whose clip moves morph targets, such as the frames of a mesh, one target each, is a character like any other.

#include "acd/transfer.h"
#include "collision/hulls/hull_fit.h"
#include "collision/live/live_body.h"
#include "geometry/convex_hull.h"
#include "session/prepare/subject.h"
#include "session/prepare/training_motions.h"
#include "skinning/linear_blend.h"
#include "tests/skinning/import/glb_writer.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <span>

namespace lorica::test {
namespace {

/// Sheared into a parabola, which keeps the volume: the upper end is `reach` aside.
Vec3 bent(const Vec3& p, double reach) {
  return {p.x() + reach * p.y() * p.y() / 4.0, p.y(), p.z()};
}

/// A bar of 0.4 x 2 x 0.4 m in ten pieces along Y.
TriMesh bar() {
  std::set<Voxel> voxels;
  for (int y = 0; y < 10; ++y) voxels.insert({0, y, 0});
  return moved(makeVoxelSurface(voxels),
               [](const Vec3& p) { return Vec3(0.4 * p.x() - 0.2, 0.2 * p.y(), 0.4 * p.z() - 0.2); });
}

double reachIn(int frame, int frames) {
  return 1.5 * std::sin(6.0 * frame / (frames - 1));
}

/// The bar's frames as targets of a mesh without a skin, each shown alone at its time.
std::string framesGlb(int frames, const nlohmann::json& node) {
  GlbWriter writer;
  const TriMesh mesh = bar();
  const int positions = writer.positions(mesh.vertices);
  const int indices = writer.triangles(mesh.triangles);
  nlohmann::json targets = nlohmann::json::array();
  std::vector<float> times, weights;
  for (int f = 0; f < frames; ++f) {
    std::vector<Vec3> offsets;
    for (const Vec3& p : mesh.vertices) offsets.push_back(bent(p, reachIn(f, frames)) - p);
    targets.push_back({{"POSITION", writer.positions(offsets)}});
    times.push_back(0.1F * static_cast<float>(f));
    for (int t = 0; t < frames; ++t) weights.push_back(t == f ? 1.0F : 0.0F);
  }
  writer.add("meshes", {{"name", "Bar"},
                        {"primitives",
                         {{{"indices", indices}, {"attributes", {{"POSITION", positions}}}, {"targets", targets}}}}});
  nlohmann::json carrier = node;
  carrier["mesh"] = 0;
  writer.add("nodes", carrier);
  writer.add("scenes", {{"nodes", {0}}});
  const int input = writer.accessor(times, "SCALAR");
  const int output = writer.accessor(weights, "SCALAR");
  writer.add("animations", {{"name", "sway"},
                            {"samplers", {{{"input", input}, {"output", output}, {"interpolation", "LINEAR"}}}},
                            {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}});
  return writer.glb();
}

struct Case {
  const char* name;
  int frames;
  nlohmann::json node;
  Affine3 modelFromMesh;
};

TEST(MorphClips, GiveKeyframesPartsAndHullsThatFollow) {
  const double half = std::sqrt(0.5);
  const Affine3 turned(Eigen::Translation3d(0.0, 1.0, 0.0) * Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitX()) *
                       Eigen::Scaling(0.5));
  const std::vector<Case> cases = {
      {"20 frames", 20, nlohmann::json::object(), Affine3::Identity()},
      {"7 frames of a node that is turned and scaled",
       7,
       {{"translation", {0.0, 1.0, 0.0}}, {"rotation", {half, 0.0, 0.0, half}}, {"scale", {0.5, 0.5, 0.5}}},
       turned}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    const TemporaryFolder folder;
    Host host;
    const Subject subject = valueOf(readSubject(folder.write("bar.glb", framesGlb(c.frames, c.node)), {}, host));
    ASSERT_TRUE(subject.character);
    const Character& character = *subject.character;
    EXPECT_FALSE(character.shapes.empty());
    EXPECT_EQ(subject.body->reachedVertices, 0);

    const Training training = valueOf(trainingMotions(subject, {}));
    ASSERT_TRUE(training.ownClips);
    const Keyframes keyframes = valueOf(trainingKeyframes(character, training, std::nullopt));
    EXPECT_GT(keyframes.count, 3);
    DecomposeSettings settings;
    settings.maxParts = 8;
    const FitRequest request{subject, keyframes, nullptr, {}, false, settings};
    const Fit fit = valueOf(fitHulls(request, host));
    EXPECT_LT(fit.quality.error, 0.3);
    EXPECT_EQ(doubtAboutHulls(fit.quality.error), "");

    // In each frame every vertex of the file is in some hull, and the body has the bar's volume.
    LiveBody body = valueOf(LiveBody::create(fit.made.decomposition, character));
    Pose pose = restPose(character.skeleton);
    std::vector<Affine3> bones(pose.size());
    std::vector<Vec3> posed(character.mesh.vertices.size());
    const double volume = 0.32 * c.modelFromMesh.linear().determinant();
    for (int f = 0; f < c.frames; ++f) {
      sampleClip(subject.file->clips[0], 0.1F * static_cast<float>(f), pose);
      computeWorldFromJoint(character.skeleton, pose, bones);
      computeWorldFromModel(character, bones, bones);
      body.update(bones);
      skinLinearBlend(character, bones, posed);
      EXPECT_NEAR(signedVolume(posed, character.mesh.triangles), volume, 1e-4);
      std::vector<ConvexHull> hulls;
      for (const LivePart& part : body.parts()) hulls.push_back(worldHull(part));
      for (const Vec3& p : bar().vertices) {
        const Vec3 at = c.modelFromMesh * bent(p, reachIn(f, c.frames));
        double out = kInfinity;
        for (const ConvexHull& hull : hulls) out = std::min(out, largestViolation(hull, std::span(&at, 1)));
        ASSERT_LT(out, 1e-4) << "frame " << f;
      }
    }
  }
}

}  // namespace
}  // namespace lorica::test
