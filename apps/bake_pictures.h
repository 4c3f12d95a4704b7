#pragma once

#include "bake/item_run.h"
#include "player/snapshots.h"

#include <filesystem>
#include <string>

namespace lorica {

/// Pictures of an item's hulls, each part in its colour.
class BakePictures {
 public:
  /// @param how  the hulls are exported by processes of this program
  [[nodiscard]] static Result<BakePictures> create(ItemRunSettings how);

  /// The hulls in the pose of the file, as the bytes of a PNG; empty if they cannot be had.
  /// @param lorica   the item's decomposition
  /// @param scratch  folder for temporary files, which exists
  [[nodiscard]] std::string draw(const BakeItem& item, const std::filesystem::path& lorica,
                                 const std::filesystem::path& scratch);

 private:
  BakePictures(ItemRunSettings how, SnapshotCamera camera) : how_(std::move(how)), camera_(std::move(camera)) {}
  ItemRunSettings how_;
  SnapshotCamera camera_;
};

}  // namespace lorica
