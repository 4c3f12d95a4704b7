#pragma once

#include "bake/file_layer.h"

#include <nlohmann/json.hpp>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace lorica {

/// A file of a result.
struct BakedFile {
  std::string name;  ///< relative to the result's folder
  std::string hash;  ///< of its content, contentHash() in hexadecimal digits
  std::uintmax_t bytes = 0;
};

/// The results of a bake: DIR/items/NAME/ with the files of an item and item.json, which describes it. A folder appears
/// there by one rename, whole or not at all.
class BakeStore {
 public:
  /// @param wait  between tries of what a file server may refuse once
  BakeStore(FileLayer& files, std::filesystem::path folder, std::function<void(std::chrono::milliseconds)> wait);

  [[nodiscard]] std::filesystem::path folderOf(const std::string& item) const { return folder_ / "items" / item; }
  /// Whether there is a result of an item.
  [[nodiscard]] bool has(const std::string& item);
  /// The description of a result; kNotFound if there is none.
  [[nodiscard]] Result<nlohmann::ordered_json> describe(const std::string& item);

  /// A new, empty folder in which an item's files are made: work/NAME.N next to items/. What is left there of a lost
  /// process is removed.
  /// @param earlier  N: the number of processes that had the item before, see Claims::claim()
  [[nodiscard]] Result<std::filesystem::path> begin(const std::string& item, int earlier);
  /// Makes a folder of begin() the result of an item.
  /// @return false if the result of another process is there already: this one is removed
  [[nodiscard]] Result<bool> publish(const std::string& item, const std::filesystem::path& made,
                                     const nlohmann::ordered_json& description);
  /// Removes a folder of begin().
  void drop(const std::filesystem::path& made);
  /// Removes work/ if nobody makes anything in it.
  void tidy() { files_->removeEmpty(folder_ / "work"); }
  /// Makes DIR/NAME a link to a file or folder of a result. What is not a link there stays.
  void link(const std::string& item, const std::string& file, const std::string& name);
  /// Takes a result away, to make it again.
  [[nodiscard]] Result<void> discard(const std::string& item);

 private:
  FileLayer* files_;
  std::filesystem::path folder_;
  std::function<void(std::chrono::milliseconds)> wait_;
};

/// The files in a folder and below it, sorted by name, with hashes of their contents; without item.json.
[[nodiscard]] Result<std::vector<BakedFile>> bakedFiles(const std::filesystem::path& folder);

/// One hash of all files of a result: of their names and hashes.
[[nodiscard]] std::string resultHash(const std::vector<BakedFile>& files);

}  // namespace lorica
