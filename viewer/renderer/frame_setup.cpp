#include "viewer/renderer/frame_setup.h"

#include "viewer/renderer/picture_area.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lorica {
namespace {

constexpr double kPropReach = 2.5;          // props within this distance of the subject get shadows [m]
constexpr double kGrainReach = 0.5;         // particles within this distance get shadows [m]
constexpr double kContactHeight = 0.30;     // max height above the floor of contact shadow casters [m]
constexpr double kTextureSeconds = 3600.0;  // textures that move start again, before floats lose precision [s]

/// sRGB.
struct Backdrop {
  Vec3f horizon, zenith, floor;
};
/// Light and dark, as on the page (stage.js).
const std::array<Backdrop, 2> kBackdrops = {
    {{{0.908f, 0.920f, 0.932f}, {0.690f, 0.750f, 0.812f}, {0.745f, 0.762f, 0.785f}},
     {{0.200f, 0.222f, 0.258f}, {0.100f, 0.115f, 0.150f}, {0.115f, 0.127f, 0.148f}}}};

void extendFinite(Aabb& box, const Vec3& p) {
  if (p.allFinite()) box.extend(p);
}

/// Extends the shadowed area by the particles near the subject; grains that rolled away do not enlarge it.
void extendToParticles(Aabb& box, const Scene& scene, const SceneOptions& options) {
  if (!options.particles) return;
  const bool alone = box.empty();
  const Vec3f middle = alone ? Vec3f::Zero() : Vec3f(box.center().cast<float>());
  const float reach = alone ? 1e3 : 0.5 * box.diagonal() + kGrainReach;
  Vec3f low = Vec3f::Constant(std::numeric_limits<float>::max()), high = -low;
  for (const Vec3f& p : scene.particles) {
    if (!((p - middle).squaredNorm() < reach * reach)) continue;
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  if (low.x() > high.x()) return;
  box.extend(low.cast<double>());
  box.extend(high.cast<double>());
}

/// Bounds of the subject: the avatar, otherwise the props, otherwise the camera's target.
Aabb subjectOf(const Scene& scene, const SceneOptions& options, const Vec3& target) {
  Aabb box;
  if (options.skin) {
    scene.eachFigure([&](const SceneFigure& figure) {
      for (const Vec3& p : figure.vertices) extendFinite(box, p);
    });
  }
  // With a skin, hulls must not change its light; an avatar is skinned on the GPU, and its hulls hold it.
  const bool hasSkin = !box.empty();
  scene.eachFigure([&](const SceneFigure& figure) {
    const bool drawn = options.skin && figure.avatar != nullptr;
    if (drawn ? !figure.vertices.empty() : (hasSkin || !options.hulls)) return;
    for (const LivePart& part : figure.parts) {
      for (const Vec3& p : part.shape.vertices) extendFinite(box, part.worldFromPart * p);
    }
  });
  extendToParticles(box, scene, options);
  if (box.empty()) extendFinite(box, target);
  if (box.empty()) box.extend(Vec3::Zero());
  if (options.props) {
    const Vec3 center = box.center();
    const double reach = 0.5 * box.diagonal() + kPropReach;
    for (const Prop& prop : scene.props) {
      const Vec3 position = prop.worldFromProp.translation();
      const double size = boundingRadius(prop);
      if (!((position - center).norm() < reach) || !std::isfinite(size)) continue;
      box.extend(position - Vec3::Constant(size));
      box.extend(position + Vec3::Constant(size));
    }
  }
  return box;
}

void setUpLight(const Scene& scene, const SceneOptions& options, const Vec3& target, int shadowSize,
                FrameSetup& setup) {
  FrameUniforms& u = setup.uniforms;
  // The key light is fixed in the world, in front and to the left of a figure that faces +Z.
  const Aabb subject = subjectOf(scene, options, target);
  const Vec3 center = subject.center();
  const Vec3 toLight = Vec3(-0.42, 1.0, 0.52).normalized();
  const Vec3 lightRight = Vec3::UnitY().cross(toLight).normalized();
  const Vec3 lightUp = toLight.cross(lightRight);
  const double radius = std::clamp(std::ceil((0.5 * subject.diagonal() + 0.05) / 0.25) * 0.25, 0.5, 8.0);
  const double texel = 2.0 * radius / shadowSize;
  const auto snapped = [&](const Vec3& axis) { return std::round(axis.dot(center) / texel) * texel; };
  Mat4 shadow = Mat4::Identity();
  shadow.row(0) << lightRight.transpose() / (2.0 * radius), 0.5 - snapped(lightRight) / (2.0 * radius);
  shadow.row(1) << lightUp.transpose() / (2.0 * radius), 0.5 - snapped(lightUp) / (2.0 * radius);
  shadow.row(2) << -toLight.transpose() / (4.0 * radius), 0.5 + toLight.dot(center) / (4.0 * radius);
  u.shadowFromWorld = shadow.cast<float>();
  u.toLight << toLight.cast<float>(), 1.0f / shadowSize;

  // The shaded part of the floor contains the contact area and the shadow of the subject's bounding sphere.
  u.contactArea << center.x(), center.z(), radius, kContactHeight;
  const Eigen::Vector2d middle(center.x(), center.z());
  const Vec3 fallen = center - toLight * (center.y() / toLight.y());
  const Eigen::Vector2d shadowMiddle(fallen.x(), fallen.z());
  const Eigen::Vector2d half = Eigen::Vector2d::Constant(radius);
  const Eigen::Vector2d shadowHalf = half / toLight.y();
  setup.shadedMin = (middle - half).cwiseMin(shadowMiddle - shadowHalf).cast<float>();
  setup.shadedMax = (middle + half).cwiseMax(shadowMiddle + shadowHalf).cast<float>();
}

}  // namespace

FrameSetup setUpFrame(const Scene& scene, const SceneOptions& options, const Camera& camera, int width, int height,
                      int shadowSize, const FrameSetup* first) {
  FrameSetup setup;
  FrameUniforms& u = setup.uniforms;

  // The camera looks along -z of its own axes.
  const double distance = std::clamp((camera.target - camera.eye).norm(), 1e-3, 1e4);
  const auto [forward, right, up] = axesOf(camera);
  const double cotangent = 1.0 / std::tan(0.5 * std::clamp(camera.verticalFov, 0.01, 3.0));
  const double aspect = camera.aspect > 0.0 ? camera.aspect : 1.0 * width / height;
  const double nearPlane = camera.nearest > 0.0 ? camera.nearest : std::clamp(0.02 * distance, 0.01, 0.5);
  const double floorEnd = 3.0 * distance + 7.0;
  const double farPlane = 3.0 * floorEnd + distance;
  Mat4 viewFromWorld = Mat4::Identity();
  viewFromWorld.row(0).head<3>() = right;
  viewFromWorld.row(1).head<3>() = up;
  viewFromWorld.row(2).head<3>() = -forward;
  viewFromWorld.col(3).head<3>() = -(viewFromWorld.topLeftCorner<3, 3>() * camera.eye);
  Mat4 clipFromView = Mat4::Zero();
  clipFromView(0, 0) = cotangent / aspect;
  clipFromView(1, 1) = cotangent;
  clipFromView(2, 2) = -(farPlane + nearPlane) / (farPlane - nearPlane);
  clipFromView(2, 3) = -2.0 * farPlane * nearPlane / (farPlane - nearPlane);
  clipFromView(0, 2) = -camera.targetAt.x();
  clipFromView(1, 2) = -camera.targetAt.y();
  clipFromView(3, 2) = -1.0;
  u.clipFromWorld = (clipFromView * viewFromWorld).cast<float>();
  u.eye << camera.eye.cast<float>(), 0.0f;
  u.rayForward << forward.cast<float>(), camera.targetAt.x();
  u.rayRight << (right * (aspect / cotangent)).cast<float>(), camera.targetAt.y();
  u.rayUp << (up / cotangent).cast<float>(), cotangent;
  u.viewport << width, height, 1.0f / width, 1.0f / height;

  u.keyColor << options.light.key, 0.0f;
  u.skyColor << options.light.sky, std::fmod(scene.time, kTextureSeconds);
  u.groundColor << options.light.ground, 0.0f;
  const Backdrop& backdrop = kBackdrops[options.dark ? 1 : 0];
  u.horizon << backdrop.horizon, 0.0f;
  u.zenith << backdrop.zenith, 0.0f;
  u.floorColor << backdrop.floor, options.dark ? 4.0f : -1.0f;

  setup.grainPixels = 0.5 * height * cotangent * static_cast<double>(scene.particleRadius) / distance;

  if (first == nullptr) {
    setUpLight(scene, options, camera.target, shadowSize, setup);
  } else {
    u.shadowFromWorld = first->uniforms.shadowFromWorld;
    u.toLight = first->uniforms.toLight;
    u.contactArea = first->uniforms.contactArea;
    setup.shadedMin = first->shadedMin;
    setup.shadedMax = first->shadedMax;
  }
  u.floorFade << u.contactArea.x(), u.contactArea.y(), 0.7 * distance + 1.0, floorEnd;
  setup.floorHalfSide = floorEnd + 2.0 * u.contactArea.z();
  return setup;
}

}  // namespace lorica
