#pragma once

#include "viewer/renderer/controls.h"
#include "viewer/renderer/image.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace lorica {

/// What the wearer of a headset can do without taking it off, the controls that are on_screen::kHeadset: rows of text
/// on a plate in the room, one of which a hand points at and chooses. Two last rows are about the headset alone.
class HeadsetPanel {
 public:
  /// Opens it before the wearer, facing them.
  void open(const Isometry3& stageFromHead);
  /// Opens it above a hand, facing the wearer, until close().
  void openAt(const Vec3& hand, const Isometry3& stageFromHead);
  void close() { open_ = false; }
  [[nodiscard]] bool isOpen() const { return open_; }

  /// The row that a ray meets; none = it goes past the panel. @param ray  stage frame
  [[nodiscard]] std::optional<std::size_t> rowAt(const Ray& ray) const;
  /// Draws the panel again if it says or marks something else.
  /// @param pointed  the row that is marked @return whether it did
  bool draw(const Controls& controls, std::optional<std::size_t> pointed);
  /// What a row as drawn last does; none = it is one of the last two.
  [[nodiscard]] std::optional<ControlId> controlOf(std::size_t row) const;
  [[nodiscard]] std::size_t rowCount() const { return rows_.size() + 2; }
  [[nodiscard]] std::size_t toAvatarRow() const { return rows_.size(); }  ///< comes to the avatar again
  [[nodiscard]] std::size_t closeRow() const { return rows_.size() + 1; }

  /// What was drawn last; RGB is premultiplied by alpha.
  [[nodiscard]] const Image& image() const { return image_; }
  /// Its middle; +X to the right of the text, +Y up, +Z to the reader.
  [[nodiscard]] const Isometry3& stageFromPanel() const { return stageFromPanel_; }
  [[nodiscard]] double width() const { return kMetres * image_.width; }    ///< [m]
  [[nodiscard]] double height() const { return kMetres * image_.height; }  ///< [m]

 private:
  void face(const Vec3& at, const Isometry3& stageFromHead);

  static constexpr double kMetres = 0.0006;  // of a pixel

  Isometry3 stageFromPanel_ = Isometry3::Identity();
  Image image_;
  bool open_ = false;
  /// A control as the image shows it.
  struct Row {
    ControlId id = ControlId::kCancel;
    double value = 0.0;
    [[nodiscard]] bool operator==(const Row&) const = default;
  };
  std::vector<Row> rows_, listed_;
  std::optional<std::size_t> pointed_;
};

}  // namespace lorica
