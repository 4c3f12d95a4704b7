#include "apps/snapshots.h"

#include "apps/options.h"
#include "apps/playback.h"
#include "collision/passengers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

namespace lorica {
namespace {

constexpr int kWidth = 1280;
constexpr int kHeight = 720;

}  // namespace

SessionScene::SessionScene(const Session& session) {
  const Decomposition& decomposition = session.body().decomposition();
  if (const Character& character = session.character(); !character.shown.empty()) {
    triangles_ = character.shown;
    std::vector<PartIndex> partOfVertex(character.mesh.vertices.size(), 0);
    const std::vector<std::vector<PointIndex>> passengers =
        passengersOf(decomposition, liftPoints(character, decomposition));
    for (std::size_t p = 0; p < passengers.size(); ++p) {
      for (const PointIndex v : passengers[p]) partOfVertex[static_cast<std::size_t>(v)] = static_cast<PartIndex>(p);
    }
    partOfTriangle_.reserve(triangles_.size());
    for (const Triangle& t : triangles_) partOfTriangle_.push_back(partOfVertex[static_cast<std::size_t>(t[0])]);
    return;
  }
  for (std::size_t p = 0; p < decomposition.parts.size(); ++p) {
    const Part& part = decomposition.parts[p];
    for (std::size_t t = 0; t < part.triangles.size(); ++t) {
      if (part.sourceTriangle[t] < 0) continue;  // a cap lies inside the body
      triangles_.push_back(part.triangles[t]);
      partOfTriangle_.push_back(static_cast<PartIndex>(p));
    }
  }
}

Scene SessionScene::of(const Session& session) const {
  Scene scene;
  scene.vertices = session.points();
  scene.triangles = triangles_;
  scene.partOfTriangle = partOfTriangle_;
  scene.parts = session.body().parts();
  scene.props = session.world().props();
  scene.contacts = session.world().contacts();
  if (const Particles* particles = session.world().particles()) {
    scene.particles = particles->places();
    scene.particleRadius = static_cast<float>(particles->settings().radius);
    scene.particleColor = particles->settings().color;
  }
  scene.skeleton = &session.character().skeleton;
  scene.worldFromJoint = session.worldFromJoint();
  return scene;
}

SnapshotCamera::SnapshotCamera(OffscreenContext context, Renderer renderer, int width, int height)
    : context_(std::move(context)),
      renderer_(std::move(renderer)),
      rendererName_(context_.description()),
      width_(width),
      height_(height) {}

Result<SnapshotCamera> SnapshotCamera::create(int width, int height) {
  Result<OffscreenContext> context = OffscreenContext::create();
  if (!context) return context.error();
  Result<Renderer> renderer = Renderer::create(context->getProc());
  if (!renderer) return renderer.error();
  return SnapshotCamera(std::move(*context), std::move(*renderer), width, height);
}

Image SnapshotCamera::draw(const Scene& scene, const SceneOptions& options, const Camera& camera) {
  renderer_.draw(scene, options, camera, width_, height_);
  return renderer_.readBack();
}

CLI::Option* addSnapshotOptions(CLI::App& app, SnapshotOptions& options) {
  CLI::Option* snapshots =
      app.add_option("--snapshots", options.folder, "Write pictures to this folder")->type_name("DIR");
  addCount(app, "--every", options.every, 1, "A picture every so many frames [default: 30]")->needs(snapshots);
  addCameraOptions(app, options.camera);
  for (const char* name : {"--camera", "--eye"}) app.get_option(name)->needs(snapshots);
  return snapshots;
}

Result<void> checkSnapshots(const SnapshotOptions& options) {
  return options.folder.empty() ? Result<void>() : checkOutputFolder("--snapshots", options.folder);
}

Result<std::optional<SnapshotSeries>> SnapshotSeries::create(const SnapshotOptions& options, const Session& session) {
  if (options.folder.empty()) return std::optional<SnapshotSeries>();
  Result<FollowCamera> follow = FollowCamera::create(options.camera, kWidth, kHeight);
  if (!follow) return follow.error();
  Result<SnapshotCamera> pictures = SnapshotCamera::create(kWidth, kHeight);
  if (!pictures) return pictures.error();
  std::error_code error;
  std::filesystem::create_directories(options.folder, error);
  if (error) {
    return Error{ErrorCode::kUnwritable, fmt::format("--snapshots: {}: {}", options.folder, error.message())};
  }
  return std::optional<SnapshotSeries>(SnapshotSeries(options, std::move(*pictures), *follow, session));
}

SnapshotSeries::SnapshotSeries(const SnapshotOptions& options, SnapshotCamera pictures, FollowCamera follow,
                               const Session& session)
    : options_(options), pictures_(std::move(pictures)), scene_(session), follow_(std::move(follow)) {}

Result<void> SnapshotSeries::add(const Session& session, const std::string& name, const Image* inset) {
  if (!firstTime_) firstTime_ = previousTime_ = session.time();
  follow_.update(session, session.time() - previousTime_);
  previousTime_ = session.time();
  if (!due(session)) return {};
  SceneOptions show;
  show.caption = captionOf(name, session, session.time() - *firstTime_);
  Scene scene = scene_.of(session);
  scene.inset = inset;
  const Image image = pictures_.draw(scene, show, follow_.camera());
  const std::filesystem::path file =
      std::filesystem::path(options_.folder) / fmt::format("frame_{:04}.png", session.frameCount() - 1);
  if (Result<void> saved = writePng(file, image); !saved) return saved;
  ++written_;
  return {};
}

}  // namespace lorica
