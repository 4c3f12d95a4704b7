// Uses the installed library from outside: decomposes an L-shaped prism into two boxes, steps a world, draws a label,
// and looks for the installed recordings.

#include "acd/decompose.h"
#include "acd/transfer.h"
#include "capture/files/joint_csv.h"
#include "collision/world/world.h"
#include "viewer/image.h"

#include <cmath>
#include <cstdio>
#include <filesystem>

namespace {

/// Profile (0,0) (2,0) (2,1) (1,1) (1,2) (0,2), extruded by 1: volume 3, one concave edge.
lorica::TriMesh makeLShape() {
  lorica::TriMesh mesh;
  const double profile[6][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (const double z : {0.0, 1.0}) {
    for (const auto& p : profile) mesh.vertices.emplace_back(p[0], p[1], z);
  }
  const lorica::Triangle cap[] = {{0, 1, 3}, {1, 2, 3}, {0, 3, 5}, {3, 4, 5}};
  for (const lorica::Triangle& t : cap) {
    mesh.triangles.push_back({t[0], t[2], t[1]});
    mesh.triangles.push_back({t[0] + 6, t[1] + 6, t[2] + 6});
  }
  for (int i = 0; i < 6; ++i) {
    const int j = (i + 1) % 6;
    mesh.triangles.push_back({i, j, j + 6});
    mesh.triangles.push_back({i, j + 6, i + 6});
  }
  return mesh;
}

int fail(const char* what) {
  std::fprintf(stderr, "consumer: %s\n", what);
  return 1;
}

}  // namespace

int main() {
  const lorica::TriMesh mesh = makeLShape();
  const int vertexCount = static_cast<int>(mesh.vertices.size());
  const auto decomposition = lorica::decompose(mesh, {mesh.vertices, vertexCount}, {.maxParts = 2});
  if (!decomposition) return fail(decomposition.error().message.c_str());
  if (decomposition->parts.size() != 2) return fail("expected two parts of the L-shape");

  std::vector<lorica::Vec3> points(static_cast<std::size_t>(decomposition->pointCount()));
  lorica::transfer(*decomposition, mesh.vertices, points);
  double volume = 0.0;
  for (const lorica::Part& part : decomposition->parts) {
    const lorica::ConvexHull hull = lorica::partHull(part, points);
    std::printf("part with %zu hull vertices, volume %.3f\n", hull.vertices.size(), hull.volume);
    volume += hull.volume;
  }
  if (std::abs(volume - 3.0) > 1e-9) return fail("expected two boxes of volume 3 together");

  // A ball dropped from one metre lies on the floor after three seconds.
  lorica::World world;
  lorica::Prop ball;
  ball.shape = lorica::PropShape::kSphere;
  ball.worldFromProp.translation() = lorica::Vec3(0, 1, 0);
  world.addProp(ball);
  for (int frame = 0; frame < 90; ++frame) world.step({}, 1.0 / 30.0);
  const double height = world.props()[0].worldFromProp.translation().y();
  std::printf("ball rests at %.3f m\n", height);
  if (std::abs(height - 0.1) > 0.02) return fail("expected the ball to rest at its radius, 0.1 m");

  // Text is drawn by a module that the library loads when it is first needed.
  const std::vector<lorica::Image> picture(1, {64, 48, std::vector<std::uint8_t>(64 * 48 * 4, 255)});
  const std::vector<std::string> label = {"hull"};
  const lorica::Image sheet = lorica::contactSheet(picture, label, 1);
  std::size_t dark = 0;
  for (std::size_t i = 0; i < sheet.rgba.size(); i += 4) dark += sheet.rgba[i] < 128 ? 1 : 0;
  std::printf("%zu pixels of text\n", dark);
  if (dark < 20) return fail("expected a label under the picture");

  int recordings = 0;
  for (const auto& entry : std::filesystem::directory_iterator(LORICA_RECORDINGS_DIR)) {
    if (entry.path().extension() != ".csv") continue;
    const auto frames = lorica::readJointCsv(entry.path());
    if (!frames) return fail(frames.error().message.c_str());
    ++recordings;
  }
  std::printf("%d recordings installed\n", recordings);
  return recordings >= 6 ? 0 : fail("expected at least six recordings in " LORICA_RECORDINGS_DIR);
}
