#pragma once

#include "export/bake/bake_job.h"
#include "export/bake/bake_store.h"

#include <functional>
#include <span>

namespace lorica {

/// The results of a list, merged.
struct BakeCollection {
  std::vector<nlohmann::ordered_json> results;  ///< descriptions, see BakeStore, in the order of the list
  std::vector<std::string> missing;             ///< inputs without a result
  std::vector<std::string> damaged;             ///< a sentence for each file that is not what its description says

  [[nodiscard]] std::vector<const nlohmann::ordered_json*> failed() const;
  /// Results that are not failures, those with the largest error of their hulls first.
  [[nodiscard]] std::vector<const nlohmann::ordered_json*> worstFirst() const;
  /// One hash of all results, which does not depend on who made them and when.
  [[nodiscard]] std::string hash() const;
};

/// Reads the result of every job. Goes by the list, not by what a file server lists in a folder.
/// @param checkFiles  also read every file and compare it with its hash
[[nodiscard]] BakeCollection collect(std::span<const BakeJob> jobs, const BakeStore& store, bool checkFiles);

/// Makes links to the files of all results, DIR/hero.glb to DIR/items/hero-0123456789abcdef/hero.glb. Of several inputs
/// of one stem each has the key in the links' names too. What is not a link there stays.
/// @param folder  DIR
void linkResults(const BakeCollection& collection, std::span<const BakeJob> jobs, const std::filesystem::path& folder);

/// A line of JSON for each result.
[[nodiscard]] std::string jsonLines(const BakeCollection& collection);

/// The error that counts: in held-out poses for characters, else that of the hulls.
[[nodiscard]] double errorOf(const nlohmann::ordered_json& result);

/// A picture of an item as the bytes of a PNG; empty if there is none.
using BakePicture = std::function<std::string(const nlohmann::ordered_json& result)>;

/// The report as one HTML file: figures, histograms of error, time and parts, failures with their sentences, pictures
/// of the worst twenty, and a table of all results.
[[nodiscard]] std::string htmlReport(const BakeCollection& collection, const BakePicture& picture);

}  // namespace lorica
