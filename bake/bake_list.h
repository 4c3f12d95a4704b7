#pragma once

#include "bake/bake_settings.h"

#include <span>

namespace lorica {

/// One thing to do: an input and what is done with it.
struct BakeItem {
  std::string input;  ///< path of a mesh or character, or the name of a built-in one
  BakeSettings settings;
};

/// Reads lists of inputs. Each of them is
///   - a mesh or character file, or the name of a built-in character;
///   - a folder: all meshes and characters in it and below, by name;
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
