#include "tests/bench/depth_overlay.h"

#include "tests/bench/real_recordings.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <utility>

namespace lorica::bench {
namespace {

using J = BodyJoint;
constexpr std::array<std::pair<J, J>, 14> kBones = {{{J::kHead, J::kNeck},
                                                     {J::kNeck, J::kLeftShoulder},
                                                     {J::kNeck, J::kRightShoulder},
                                                     {J::kLeftShoulder, J::kLeftElbow},
                                                     {J::kRightShoulder, J::kRightElbow},
                                                     {J::kLeftElbow, J::kLeftHand},
                                                     {J::kRightElbow, J::kRightHand},
                                                     {J::kNeck, J::kTorso},
                                                     {J::kTorso, J::kLeftHip},
                                                     {J::kTorso, J::kRightHip},
                                                     {J::kLeftHip, J::kLeftKnee},
                                                     {J::kRightHip, J::kRightKnee},
                                                     {J::kLeftKnee, J::kLeftFoot},
                                                     {J::kRightKnee, J::kRightFoot}}};
constexpr int kScale = 2;

bool isLeft(J joint) {
  return nameOf(joint).starts_with("left");
}

}  // namespace

DrawnSkeleton trackedSkeleton(const SkeletonFrame& frame) {
  DrawnSkeleton drawn{positionsOf(frame), {}, {255, 50, 40}};
  for (std::size_t j = 0; j < kBodyJointCount; ++j) drawn.sure[j] = frame.joints[j].confidence >= 0.5;
  return drawn;
}

Image depthOverlay(const DepthCamera& camera, std::span<const std::uint16_t> depthMm,
                   std::span<const std::uint8_t> labels, std::span<const DrawnSkeleton> skeletons) {
  std::uint16_t nearest = 0xffff, farthest = 1;
  for (const std::uint16_t depth : depthMm) {
    if (depth == 0) continue;
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, std::min<std::uint16_t>(depth, 6000));
  }
  cv::Mat picture(camera.height, camera.width, CV_8UC4, cv::Scalar(0, 0, 0, 255));
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const auto i = static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(x);
      if (depthMm[i] == 0) continue;
      const float away = static_cast<float>(std::min(depthMm[i], farthest) - nearest) /
                         static_cast<float>(std::max(1, farthest - nearest));
      const float grey = 220.0F - 170.0F * away;
      cv::Vec4b& pixel = picture.at<cv::Vec4b>(y, x);
      const bool person = labels[i] != 0 && labels[i] != 255;
      pixel[0] = static_cast<std::uint8_t>(person && labels[i] != 1 ? grey : grey * (person ? 0.6F : 1.0F));
      pixel[1] = static_cast<std::uint8_t>(grey * (person ? 0.75F : 1.0F));
      pixel[2] = static_cast<std::uint8_t>(person && labels[i] == 1 ? grey : grey * (person ? 0.5F : 1.0F));
    }
  }
  cv::resize(picture, picture, {}, kScale, kScale, cv::INTER_NEAREST);
  for (const DrawnSkeleton& one : skeletons) {
    const auto pixelOf = [&](J joint) {
      Vec3 position = one.joints[static_cast<std::size_t>(joint)];
      position.z() = std::min(position.z(), -0.1);
      const Eigen::Vector2d point = kScale * camera.imagePointOf(position);
      return cv::Point2d(point.x(), point.y());
    };
    for (const auto& [a, b] : kBones) {
      const double bright = isLeft(a) || isLeft(b) ? 1.0 : 0.6;
      const bool sure = one.sure[static_cast<std::size_t>(a)] && one.sure[static_cast<std::size_t>(b)];
      cv::line(picture, pixelOf(a), pixelOf(b),
               cv::Scalar(bright * one.colour[0], bright * one.colour[1], bright * one.colour[2], 255), sure ? 3 : 1,
               cv::LINE_AA);
    }
  }
  Image image;
  image.width = picture.cols;
  image.height = picture.rows;
  image.rgba.assign(picture.datastart, picture.dataend);
  return image;
}

}  // namespace lorica::bench
