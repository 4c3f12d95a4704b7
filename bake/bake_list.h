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

/// Sets a value, or several separated by semicolons. Numbers, words and lists are checked; files are not.
/// @param folder  which the names of files are relative to; empty = as they are
/// @return or an error: "parts: found `x`, expected a whole number above 0"
[[nodiscard]] Result<void> setBakeSetting(BakeSettings& settings, const std::string& name, const std::string& value,
                                          const std::string& folder);

/// "parts, max-error, ...", for messages and help.
[[nodiscard]] std::string bakeSettingNames();

/// The settings as one line, the same for the same settings: "parts=16 motion=walk;run".
[[nodiscard]] std::string textOf(const BakeSettings& settings);

/// A path relative to a folder; a word without folder and ending is the name of something that ships with Lorica.
[[nodiscard]] std::string relativeTo(const std::string& folder, const std::string& name);

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
