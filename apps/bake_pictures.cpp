#include "apps/bake_pictures.h"

#include "apps/interrupt.h"
#include "geometry/files.h"
#include "geometry/mesh_files.h"
#include "player/parts_picture.h"
#include "viewer/pictures/image_files.h"

#include <chrono>
#include <thread>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 400;
constexpr int kHeight = 300;

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
  if (!writePng(png, drawParts(*objects, camera_))) return "";
  const Result<std::string> bytes = readFile(png, NamedBy::kFile);
  return bytes ? *bytes : "";
}

}  // namespace lorica
