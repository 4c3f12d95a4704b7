#include "apps/bake_pictures.h"

#include "apps/interrupt.h"
#include "geometry/files.h"
#include "geometry/mesh_files.h"
#include "viewer/image.h"

#include <chrono>
#include <thread>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 400;
constexpr int kHeight = 300;
constexpr double kSize = 1.8;  // of the longest diagonal in the picture's world [m]

/// Runs the program to its end. @return whether it succeeded; not if Ctrl-C came
bool runs(const ItemRunSettings& how, std::vector<std::string> arguments, const fs::path& scratch) {
  Result<ChildProcess> process =
      ChildProcess::start({how.program, std::move(arguments), {{"XDG_CACHE_HOME", scratch}}, scratch / "log", 0});
  std::optional<ProcessEnd> end;
  while (process && !interrupted() && !(end = process->ended())) {
    std::this_thread::sleep_for(std::chrono::milliseconds(4));
  }
  return end && end->exitStatus == 0 && end->signal == 0;
}

/// One mesh of all objects, moved onto the floor and scaled.
TriMesh joined(const std::vector<NamedMesh>& objects, std::vector<PartIndex>& partOfTriangle) {
  TriMesh all;
  Aabb box;
  for (const NamedMesh& object : objects) {
    const VertexIndex first = all.vertices.size();
    for (const Vec3& p : object.mesh.vertices) {
      all.vertices.push_back(p);
      box.extend(p);
    }
    for (const Triangle& t : object.mesh.triangles) {
      all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      partOfTriangle.push_back(&object - objects.data());
    }
  }
  const double scale = box.diagonal() > 0.0 ? kSize / box.diagonal() : 1.0;
  const Vec3 middle = 0.5 * (box.min + box.max);
  for (Vec3& p : all.vertices) p = scale * (p - Vec3(middle.x(), box.min.y(), middle.z()));
  return all;
}

}  // namespace

Result<BakePictures> BakePictures::create(ItemRunSettings how) {
  LORICA_TRY(SnapshotCamera camera, SnapshotCamera::create(kWidth, kHeight));
  return BakePictures(std::move(how), std::move(camera));
}

std::string BakePictures::draw(const BakeItem& item, const fs::path& lorica, const fs::path& scratch) {
  const fs::path hulls = scratch / "hulls.obj";
  const fs::path png = scratch / "hulls.png";
  if (!runs(how_, exportArguments(item, lorica, hulls, how_), scratch)) return "";
  const Result<std::vector<NamedMesh>> objects = readObjObjects(hulls);
  if (!objects) return "";
  std::vector<PartIndex> partOfTriangle;
  const TriMesh mesh = joined(*objects, partOfTriangle);
  Scene scene;
  scene.vertices = mesh.vertices;
  scene.triangles = mesh.triangles;
  scene.partOfTriangle = partOfTriangle;
  SceneOptions show;
  show.hulls = false;
  Camera camera;
  double top = 0.0;
  for (const Vec3& p : mesh.vertices) top = std::max(top, p.y());
  camera.target = Vec3(0.0, 0.5 * top, 0.0);
  camera.eye = camera.target + Vec3(1.6, 1.1, 2.6);
  if (!writePng(png, camera_.draw(scene, show, camera))) return "";
  const Result<std::string> bytes = readFile(png, NamedBy::kFile);
  return bytes ? *bytes : "";
}

}  // namespace lorica
