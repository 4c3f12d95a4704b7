#include "apps/snapshots.h"

#include "collision/passengers.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lorica {
namespace {

constexpr double kFollowSeconds = 0.6;  // time constant of the camera
constexpr double kTargetHeight = 0.54;  // of the character's height: the middle of a standing body

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
  scene.skeleton = &session.character().skeleton;
  scene.worldFromJoint = session.worldFromJoint();
  return scene;
}

void FollowCamera::update(const Session& session, double seconds) {
  Vec3 wanted = Vec3::Zero();
  for (const LivePart& part : session.body().parts()) wanted += part.worldFromPart.translation();
  wanted /= static_cast<double>(session.body().parts().size());
  height_ = session.character().height;
  wanted.y() = kTargetHeight * height_;
  const double step = started_ ? 1.0 - std::exp(-seconds / kFollowSeconds) : 1.0;
  target_ += step * (wanted - target_);
  started_ = true;
}

Camera FollowCamera::camera() const {
  Camera camera;
  camera.target = target_;
  camera.eye = target_ + heights_ * height_ * kViewDirection;
  return camera;
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

}  // namespace lorica
