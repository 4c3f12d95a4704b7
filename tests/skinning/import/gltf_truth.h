#pragma once

#include "geometry/math.h"

#include <nlohmann/json.hpp>

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace lorica::test {

/// The rotation of a unit quaternion (x, y, z, w).
[[nodiscard]] Mat4 rotationMatrix(const Eigen::Vector4d& q);

/// The glTF 2.0 specification, evaluated directly from a GLB's JSON and bytes with 4x4 matrices, without any code of
/// import/. For files that conform to the specification.
class GltfTruth {
 public:
  explicit GltfTruth(std::string_view glb);
  static GltfTruth ofFile(const std::filesystem::path& file);

  using Corners = std::array<Vec3, 3>;

  /// The triangles that the default scene draws, in the file's own units and axes: nodes in order, their primitives,
  /// their triangles; without those that use a vertex twice.
  /// @param animation  -1: at rest
  /// @param morphing   whether the animation moves weights of morph targets, too
  [[nodiscard]] std::vector<Corners> triangles(int animation, double time, bool morphing = false) const;

  [[nodiscard]] int animationCount() const;
  /// Time of the last key of the channels that move nodes [s].
  [[nodiscard]] double seconds(int animation) const;
  [[nodiscard]] const nlohmann::json& document() const { return document_; }

 private:
  [[nodiscard]] double number(int accessor, std::size_t element, std::size_t component) const;
  [[nodiscard]] double numberInFile(int accessor, std::size_t element, std::size_t component) const;
  [[nodiscard]] double stored(const nlohmann::json& accessor, int view, std::size_t offset, std::size_t element,
                              std::size_t component) const;
  [[nodiscard]] std::size_t count(int accessor) const;
  /// @param scalars  how many numbers a key has, if its accessor has one after the other; else 0
  [[nodiscard]] std::vector<double> sampled(const nlohmann::json& sampler, bool rotation, double time,
                                            std::size_t scalars = 0) const;
  [[nodiscard]] Mat4 local(int node, int animation, double time) const;
  [[nodiscard]] std::vector<Mat4> globals(int animation, double time) const;

  nlohmann::json document_;
  std::string binary_;
  mutable std::map<int, std::vector<double>> numbers_;  // cached per accessor
};

}  // namespace lorica::test
