#pragma once

#include "viewer/renderer/scene.h"

namespace lorica {

/// The uniform block "Frame" of the shaders (std140): camera, light and floor of one picture.
struct FrameUniforms {
  Eigen::Matrix4f clipFromWorld;
  Eigen::Matrix4f shadowFromWorld;
  Eigen::Vector4f eye;
  Eigen::Vector4f rayForward;
  Eigen::Vector4f rayRight;
  Eigen::Vector4f rayUp;
  Eigen::Vector4f toLight;
  Eigen::Vector4f contactArea;
  Eigen::Vector4f floorFade;
  Eigen::Vector4f viewport;
  Eigen::Vector4f keyColor;
  Eigen::Vector4f skyColor;
  Eigen::Vector4f groundColor;
  Eigen::Vector4f horizon;
  Eigen::Vector4f zenith;
  Eigen::Vector4f floorColor;
};
static_assert(sizeof(FrameUniforms) == 2 * 64 + 14 * 16);

struct FrameSetup {
  FrameUniforms uniforms;
  /// Area of the floor around the subject that shadows can reach, in xz [m].
  Eigen::Vector2f shadedMin, shadedMax;
  float grainPixels = 0;    ///< radius of a particle near the camera's target [pixels]
  float floorHalfSide = 0;  ///< half side of the whole floor around uniforms.floorFade [m]
};

/// Sets up camera and key light. The light's area follows the subject in whole shadow texels and grows in steps, so
/// that shadows do not crawl when the subject moves.
/// @param shadowSize  texels per side of the shadow map
/// @param first       of the same scene from another eye, whose light and shadows are this one's; null = none
[[nodiscard]] FrameSetup setUpFrame(const Scene& scene, const SceneOptions& options, const Camera& camera, int width,
                                    int height, int shadowSize, const FrameSetup* first = nullptr);

}  // namespace lorica
