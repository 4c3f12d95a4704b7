#pragma once

#include "capture/sensor/depth_frame.h"
#include "capture/tracking/body_model.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica::fit {

/// What of a depth image one person's fit asks for: evenly spread surface points with normals, and, for each block of
/// 4 x 4 pixels around the person, how far it is from the person's outline and what depth was seen there.
class BodyView {
 public:
  static constexpr int kBlock = 4;  ///< pixels

  struct Point {
    V3 place;                   ///< floor frame [m]
    V3 normal;                  ///< out of the surface, floor frame; zero where unknown
    V3 ray;                     ///< unit, from the camera to the point
    std::uint16_t column, row;  ///< of the block
  };

  explicit BodyView(const DepthCamera& camera);

  /// @param depthMm          of the frame
  /// @param labels           width x height: 0 background, 255 not measured, else a person
  /// @param label            of the person to look at
  /// @param floorFromCamera  rigid
  void look(std::span<const std::uint16_t> depthMm, std::span<const std::uint8_t> labels, std::uint8_t label,
            const Isometry3& floorFromCamera);

  /// In an order whose every beginning is spread evenly over the person.
  [[nodiscard]] std::span<const Point> points() const { return points_; }
  /// That one point stands for, across the view [m^2].
  [[nodiscard]] float areaOf(const Point& point) const {
    const float away = (point.place - cameraPlace_).norm();
    return kBlock * kBlock * away * away / (focalX_ * focalY_);
  }
  [[nodiscard]] const V3& cameraPlace() const { return cameraPlace_; }
  /// Whether the person touches the image's border, more than just so.
  [[nodiscard]] bool cut() const { return cut_; }
  /// Floor frame, the median of each coordinate.
  [[nodiscard]] const V3& middle() const { return middle_; }

  struct Sight {
    bool inside;    ///< the image
    float outside;  ///< distance from the person's outline, negative inside it [blocks]
    V3 gradient;  ///< of `outside` times metresPerBlock in place: the way out of the person, floor frame; unit or less
    float metresPerBlock;
    float depth;  ///< of the point, along the axis [m]
    float seen;   ///< the depth there: of the person or of what is before them; 0 = none [m]
    bool person;  ///< the block shows the person
    V3 axis;      ///< unit, the camera's viewing direction, floor frame
  };
  /// What the camera saw where a point projects to. @param place  floor frame
  [[nodiscard]] Sight sightOf(const V3& place) const;

 private:
  struct Block {
    float depth = 0.0F;  ///< [m]
    std::uint8_t kind = 0;
  };
  void gather(std::span<const std::uint16_t> depthMm, std::span<const std::uint8_t> labels, std::uint8_t label);
  void distances();
  void makePoints();
  [[nodiscard]] V3 cameraPlaceOf(float column, float row, float depth) const;

  DepthCamera camera_;
  float focalX_, focalY_;
  int columns_, rows_;
  int left_ = 0, top_ = 0, right_ = 0, bottom_ = 0;  ///< of the person with a margin [blocks]
  std::vector<Block> blocks_;
  std::vector<V3> places_;      ///< camera frame, of person blocks
  std::vector<float> outside_;  ///< [blocks]
  std::vector<float> scratch_;
  std::vector<Point> points_;
  std::array<std::vector<std::uint32_t>, 64> byRank_;
  M3 floorFromCamera_ = M3::Identity();
  V3 cameraPlace_ = V3::Zero();
  V3 middle_ = V3::Zero();
  bool cut_ = false;
};

}  // namespace lorica::fit
