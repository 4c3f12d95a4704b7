#pragma once

#include "geometry/result.h"

#include <map>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// What is done with one input: values by the names of `lorica decompose`'s options, without dashes ("parts",
/// "max-error"), and "export", the endings of the files to write besides. Most have one value; "motion", "hide" and
/// "export" have several. What is not there is decompose's default.
using BakeSettings = std::map<std::string, std::vector<std::string>>;

/// Checks the text of a setting: one value, or several separated by semicolons. Files need not be there.
/// @param folder  which the names of files are relative to; empty = as they are
/// @return its values, or an error: "parts: found `x`, expected a whole number above 0"
[[nodiscard]] Result<std::vector<std::string>> bakeSetting(const std::string& name, const std::string& value,
                                                           const std::string& folder);

/// The description in the folder of a result, and how folders begin in which one is being made.
inline constexpr const char* kBakeDescription = "item.json";
inline constexpr const char* kBakeWork = ".bake-";

/// The settings as one line, the same for the same settings: "parts=16 motion=walk;run".
[[nodiscard]] std::string textOf(const BakeSettings& settings);

/// One thing to do: an input and what is done with it.
struct BakeItem {
  std::string input;  ///< path of a mesh or character, or the name of a built-in one
  BakeSettings settings;
};

/// Reads lists of inputs. Each of them is
///   - a mesh or character file, or the name of a built-in character;
///   - a folder: all meshes and characters in it and below, by name, but for results of a bake;
///   - a pattern with * ? [ that is no file: the files that fit, by name;
///   - a .csv file whose first line names the columns: `input`, and settings; empty cells are the default's;
///   - a .jsonl file with an object on each line: "input", and settings as numbers, words or lists of them;
///   - any other file: one of the first three on each line; empty lines and those that begin with # do not count.
/// Files that a list names are relative to the list's own folder. Files that are missing are items too, which fail.
/// @param defaults  settings of items that do not say otherwise
/// @return the items, in the order of the lists, or an error with file and line
[[nodiscard]] Result<std::vector<BakeItem>> readBakeLists(std::span<const std::string> lists,
                                                          const BakeSettings& defaults);

}  // namespace lorica
