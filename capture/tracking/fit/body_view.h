#pragma once

#include "capture/sensor/depth_frame.h"
#include "capture/tracking/fit/body_model.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace lorica::fit {

/// Whether a camera has so few pixels that the tracker looks at blocks half as wide.
[[nodiscard]] inline bool isSmall(const DepthCamera& camera) {
  return camera.width * camera.height < 400 * 300;
}

/// What a headset says of the person, floor frame.
struct WornView {
  V3 head;   ///< the head joint [m]
  V3 ahead;  ///< unit, level: where the headset looks
};

/// The part of a depth image that one person's fit needs: evenly distributed surface points with normals, and for each
/// block of pixels around the person the distance from the person's outline and the depth seen there.
class BodyView {
 public:
  struct Point {
    V3 position;                ///< floor frame [m]
    V3 normal;                  ///< out of the surface, floor frame; zero if unknown
    V3 ray;                     ///< unit, from the camera to the point
    std::uint16_t column, row;  ///< of the block
  };

  explicit BodyView(const DepthCamera& camera);

  /// @param depthMm          of the frame
  /// @param labels           width x height: 0 background, 255 not measured, else a person
  /// @param label            of the person to look at
  /// @param floorFromCamera  rigid
  /// @param floorFound       whether y = 0 is the floor; else the ground is where the person's lowest points are
  void look(std::span<const std::uint16_t> depthMm, std::span<const std::uint8_t> labels, std::uint8_t label,
            const Isometry3& floorFromCamera, bool floorFound = true);

  /// Ordered such that every prefix is evenly distributed over the person.
  [[nodiscard]] std::span<const Point> points() const { return points_; }
  /// Area that one block represents, perpendicular to the view [m^2].
  [[nodiscard]] float areaOf(const Point& point) const { return areaAt(point.position); }
  /// Of the person, about, as seen from the camera [m^2].
  [[nodiscard]] float seenArea() const {
    // Near the camera, a single point may be a hand at half the distance.
    return points_.empty() ? 0.0F : blockCount_ * areaAt(waistUp_ ? middle_ : points_.front().position);
  }
  [[nodiscard]] const V3& cameraPosition() const { return cameraPosition_; }
  /// Whether the person clearly touches the border of what the camera measures.
  [[nodiscard]] bool cut() const { return cut_; }
  /// Whether the lower border cuts the person off, and the upper one.
  [[nodiscard]] bool cutBelow() const { return cutBelow_; }
  [[nodiscard]] bool cutAbove() const { return cutAbove_; }
  /// Heights of the lowest and the highest points, without a few outliers [m].
  [[nodiscard]] float bottom() const { return bottomHeight_; }
  [[nodiscard]] float top() const { return topHeight_; }
  /// Whether the hips and all below them are under the lower border: legs are not fitted.
  [[nodiscard]] bool waistUp() const { return waistUp_; }
  void setWaistUp(bool waistUp) { waistUp_ = waistUp; }
  /// Whether filters of the camera have blurred edges: what is on them is left out.
  [[nodiscard]] bool blurred() const { return blurred_; }
  /// Whether the person is connected to the room: some points and parts of the outline may be the room's.
  [[nodiscard]] bool attached() const { return attached_; }
  void setAttached(bool attached) { attached_ = attached; }
  /// Of the person's headset, if they wear one.
  [[nodiscard]] const std::optional<WornView>& worn() const { return worn_; }
  void setWorn(const std::optional<WornView>& worn);
  /// Only waist, legs and feet are expected in the image.
  [[nodiscard]] bool lowerBody() const { return lowerBody_; }
  void setLowerBody(bool lowerBody) { lowerBody_ = lowerBody; }
  /// Whether the head is known to be outside the image, and where.
  [[nodiscard]] bool headOutside() const { return headOutside_; }
  /// Height of the ground under the person: 0 if the floor was found; nothing if the feet are outside the image [m].
  [[nodiscard]] std::optional<float> ground() const { return ground_; }
  /// Floor frame, the median of each coordinate.
  [[nodiscard]] const V3& middle() const { return middle_; }

  struct Sight {
    bool inside;    ///< whether the point projects into the part of the image that the camera measures
    float outside;  ///< distance from the person's outline, negative inside it; what is in front of the person counts
                    ///< as inside, since it may hide more of them [blocks]
    V3 gradient;    ///< of `outside` times metresPerBlock with respect to position: points away from the person; floor
                    ///< frame; length <= 1
    float metresPerBlock;
    float depth;  ///< of the point, along the axis [m]
    float seen;   ///< the depth measured there: the person or an occluder in front; 0 = none [m]
    bool person;  ///< the block shows the person
    V3 axis;      ///< unit, the camera's viewing direction, floor frame
  };
  /// What the camera saw where a point projects to.
  /// @param position  floor frame
  [[nodiscard]] Sight sightOf(const V3& position) const;

 private:
  struct Block {
    float depth = 0.0F;  ///< [m]
    std::uint8_t kind = 0;
  };
  void gather(std::span<const std::uint16_t> depthMm, std::span<const std::uint8_t> labels, std::uint8_t label);
  [[nodiscard]] bool isBlurred(std::span<const std::uint16_t> depthMm) const;
  void dropRamps();
  void findMargins();
  template <typename Relax>
  void sweep(const Relax& relax) const;
  void markOccluders();
  void distances();
  void makePoints();
  void findGround(bool floorFound);
  [[nodiscard]] float areaAt(const V3& position) const {
    return block_ * block_ * (position - cameraPosition_).squaredNorm() / (focalX_ * focalY_);
  }
  [[nodiscard]] std::size_t indexOf(int column, int row) const {
    return static_cast<std::size_t>(row) * columns_ + column;
  }
  [[nodiscard]] V3 cameraPositionOf(float column, float row, float depth) const;

  DepthCamera camera_;
  int block_;  ///< pixels along either side of a block: 4, or 2 if the image is small
  float focalX_, focalY_;
  int columns_, rows_;
  int left_ = 0, top_ = 0, right_ = 0, bottom_ = 0;  ///< of the person with a margin [blocks]
  std::vector<Block> blocks_;
  std::vector<V3> positions_;   ///< camera frame, of person blocks
  std::vector<float> outside_;  ///< [blocks]
  std::vector<float> scratch_;
  std::vector<Point> points_;
  std::array<std::vector<std::uint32_t>, 64> byRank_;
  M3 floorFromCamera_ = M3::Identity();
  V3 cameraPosition_ = V3::Zero();
  V3 middle_ = V3::Zero();
  std::optional<float> ground_;
  bool cut_ = false;
  bool blurred_ = false;
  bool attached_ = false;
  std::optional<WornView> worn_;
  bool headOutside_ = false;
  bool lowerBody_ = false;
  bool cutBelow_ = false, cutAbove_ = false;
  bool waistUp_ = false;
  float bottomHeight_ = 0.0F, topHeight_ = 0.0F;
  std::size_t blockCount_ = 0;                                         ///< that show the person
  int firstColumn_ = 0, lastColumn_ = 0, firstRow_ = 0, lastRow_ = 0;  ///< that the camera measures [blocks]
  std::vector<int> measured_;                                          ///< blocks of each column, then of each row
};

}  // namespace lorica::fit
