#pragma once

#include "geometry/result.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace lorica {

/// A file of a result.
struct BakedFile {
  std::string name;  ///< relative to the result's folder
  std::string hash;  ///< of its content, contentHash() in hexadecimal digits
  std::uintmax_t bytes = 0;
};

/// The results of a bake: DIR/items/NAME/ with the files of an item and item.json, which describes it. NAME has the key
/// of the item in it, so whoever makes it makes the same. A folder appears there by one rename, whole or not at all.
class BakeStore {
 public:
  explicit BakeStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  [[nodiscard]] std::filesystem::path folderOf(const std::string& item) const { return folder_ / "items" / item; }
  /// Whether there is a result of an item.
  [[nodiscard]] bool has(const std::string& item) const;
  /// The description of a result; kNotFound if there is none, kBadFormat if it is none.
  [[nodiscard]] Result<nlohmann::ordered_json> describe(const std::string& item) const;
  /// Reads every file that a description names. @return why one is not what it says; empty if all are
  [[nodiscard]] std::string damageOf(const std::string& item, const nlohmann::ordered_json& description) const;

  /// A new, empty folder beside the results, in which an item's files are made. Any number of processes and threads may
  /// have one.
  [[nodiscard]] Result<std::filesystem::path> begin() const;
  /// Makes a folder of begin() the result of an item.
  /// @return false if there is one already: this one is removed
  [[nodiscard]] Result<bool> publish(const std::string& item, const std::filesystem::path& made,
                                     const nlohmann::ordered_json& description) const;
  /// Takes a result away, to make it again.
  [[nodiscard]] Result<void> discard(const std::string& item) const;
  /// Removes what processes that were killed left of begin().
  /// @param age  of a folder to be left behind [s], by the clock of the file system alone
  void removeAbandoned(double age) const;

 private:
  std::filesystem::path folder_;
};

/// The files in a folder and below it, sorted by name, with hashes of their contents; without item.json.
[[nodiscard]] Result<std::vector<BakedFile>> bakedFiles(const std::filesystem::path& folder);

/// One hash of all files of a result: of their names and hashes.
[[nodiscard]] std::string resultHash(const std::vector<BakedFile>& files);

}  // namespace lorica
