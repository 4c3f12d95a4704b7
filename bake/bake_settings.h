#pragma once

#include "geometry/result.h"

#include <map>
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

}  // namespace lorica
