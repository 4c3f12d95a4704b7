#pragma once

#include "capture/tracking/segmentation/convolution.h"
#include "geometry/result.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// A small convolutional network that says of each pixel of a depth image whether it shows a person or the room.
///
/// It computes with integers only, so that it says the same on every machine and with every instruction set. A U-shaped
/// net: five levels, each half as wide and high as the one above, and back up again. person_network.cpp draws it.
class PersonNetwork {
 public:
  static constexpr int kWidth = 160, kHeight = 128;

  /// @param file  "LPN1", then for each convolution in the order of execution: biases (int32, little-endian), shifts
  ///              (uint8), weights (int8; 3x3: [ky][kx][in][out], 1x1: [in][out], depthwise: [ky][kx][channel])
  [[nodiscard]] static Result<PersonNetwork> fromBytes(std::span<const std::uint8_t> file);
  /// The weights that come with Lorica.
  [[nodiscard]] static PersonNetwork shipped();

  /// Allocates nothing.
  /// @param depthMm     kWidth x kHeight, top row first; 0 = nothing measured
  /// @param heightMm    over the floor, for each pixel; ignored where nothing is measured or the floor is not known
  /// @return for each pixel how likely it shows a person, as a logit: 256 is 1.0, positive is a person. Valid until the
  ///         next call
  [[nodiscard]] std::span<const std::int16_t> run(std::span<const std::uint16_t> depthMm,
                                                  std::span<const std::int16_t> heightMm, bool floorKnown);

 private:
  /// Memory for the features of one size of image.
  struct Level {
    Level(int width, int height, int channelsAbove, int channels);

    FeatureMap above;          ///< with the channels of the level above
    FeatureMap aboveFiltered;  ///< depthwise
    FeatureMap a, b;           ///< results of one block and the next
    FeatureMap filtered;       ///< depthwise
  };

  PersonNetwork();

  /// @param block  what is added if the next convolution ends a block with a residual
  void convolveNext(const FeatureMap& from, const FeatureMap& block, FeatureMap& to);
  void convolveNext(const FeatureMap& from, FeatureMap& to);
  // The next two: depthwise, then 1x1.
  void separableNext(const FeatureMap& from, FeatureMap& filtered, FeatureMap& to);

  std::vector<Convolution> convolutions_;  ///< in the order of execution
  std::size_t next_ = 0;                   ///< of these, in run()
  FeatureMap input_, early_, top_, mixed_, logitsOfCells_;
  std::array<Level, 4> levels_;
  std::vector<std::int16_t> logits_;
};

}  // namespace lorica
