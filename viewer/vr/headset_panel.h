#pragma once

#include "viewer/renderer/image.h"
#include "viewer/renderer/window_values.h"

#include <cstdint>
#include <optional>

namespace lorica {

/// A few things that the wearer of a headset can do without taking it off: rows of text on a plate in the room, one of
/// which a hand points at and chooses.
class HeadsetPanel {
 public:
  enum class Row : std::uint8_t { kPause, kRestart, kScene, kHulls, kInside, kRecentre, kFindCamera, kClose };
  static constexpr int kRows = 8;

  /// Opens it before the wearer, facing them.
  void open(const Isometry3& stageFromHead);
  /// Opens it above a hand, facing the wearer, until close().
  void openAt(const Vec3& hand, const Isometry3& stageFromHead);
  void close() { open_ = false; }
  [[nodiscard]] bool isOpen() const { return open_; }

  /// The row that a ray meets; none = it goes past the panel. @param ray  stage frame
  [[nodiscard]] std::optional<Row> rowAt(const Ray& ray) const;
  /// Draws the panel again if it says or marks something else.
  /// @param pointed  the row that is marked @return whether it did
  bool draw(const WindowValues& values, const WindowChoices& choices, std::optional<Row> pointed);
  /// Does what a row says by choices or requests, but for kRecentre and kClose.
  static void choose(Row row, const WindowValues& values, WindowChoices& choices, WindowRequests& requests);

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
  /// What the image shows.
  struct Drawn {
    bool paused = false, hulls = false, inside = false;
    int scene = 0;
    std::optional<Row> pointed;
    [[nodiscard]] bool operator==(const Drawn&) const = default;
  };
  std::optional<Drawn> drawn_;
};

}  // namespace lorica
