#pragma once

#include "geometry/result.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lorica {

struct RunSetting;
struct SnapshotOptions;

/// Exit status for rejected arguments or files, and for output that cannot be written.
inline constexpr int kBadInputStatus = 2;

/// Options of every subcommand.
struct CommonOptions {
  std::string json;         ///< file for the report as JSON; "-" = standard output instead of the text; empty = none
  int threads = 0;          ///< 0 = all that the machine has
  bool trustPaths = false;  ///< files may name files anywhere, see NamedFiles
  bool force = false;       ///< what exists may be overwritten
  std::string memory;       ///< that the command may take: "8G"; empty = see usualMemory(); not of `bake`

  /// The number of threads to use on this machine.
  [[nodiscard]] int threadCount() const;
};

/// A table of text cells. Columns fit their content; numbers are right-aligned.
struct Table {
  std::vector<std::string> headings;
  std::vector<std::vector<std::string>> rows;  ///< one cell per heading
  std::size_t textFrom = std::string::npos;    ///< columns from this one on hold text and are left-aligned
};

using Json = nlohmann::ordered_json;

/// JSON of a value that may be missing: null.
template <typename Value>
Json orNull(const std::optional<Value>& value) {
  return value ? Json(*value) : Json();
}
inline Json orNull(const std::string& text) {
  return text.empty() ? Json() : Json(text);
}

/// One thing that a command has to say.
struct Fact {
  std::string json;   ///< its name in JSON; empty = only in the text
  std::string label;  ///< of its line in the text
  Json value;         ///< in JSON; null is said too
  std::string words;  ///< in the text; empty = only in JSON
};

/// What a command has to say, each thing once, in the order of the text.
class Facts {
 public:
  /// @param words  without them the value speaks: a text, or a whole number
  void add(std::string json, std::string label, Json value, std::string words);
  void add(std::string json, std::string label, Json value);
  void add(std::string json, Json value) { list_.push_back({std::move(json), "", std::move(value), ""}); }
  /// Only in the text. Without a label it continues the line above; without words it is left out.
  void line(std::string label, std::string words);
  void gap() { list_.emplace_back(); }
  void add(const Facts& others) { list_.insert(list_.end(), others.list_.begin(), others.list_.end()); }

  /// The same for those who print the others elsewhere, or not.
  [[nodiscard]] Facts textOnly() const;
  [[nodiscard]] Facts jsonOnly() const;
  [[nodiscard]] const std::vector<Fact>& list() const { return list_; }

 private:
  std::vector<Fact> list_;
};

/// The report of a command. As text: a headline, then the facts' labels and words in aligned columns, then tables, then
/// notes. As JSON: the facts' names and values.
class Report : public Facts {
 public:
  /// @param order  names that come first in JSON, with spaces between them, where the text has another order
  explicit Report(std::string headline, std::string order = "")
      : headline_(std::move(headline)), order_(std::move(order)) {}

  void table(Table table) { tables_.push_back(std::move(table)); }
  /// Its first rows, and a note if there are more. @param rows  what they are: "clips", which JSON has all of
  void table(Table table, std::size_t most, const std::string& rows);
  /// A sentence at the end of the text.
  void note(std::string sentence) { notes_.push_back(std::move(sentence)); }
  /// For standard output; the headline is bold in a terminal unless NO_COLOR is set.
  [[nodiscard]] std::string text() const;
  [[nodiscard]] Json json() const;

 private:
  std::string headline_;
  std::string order_;
  std::vector<Table> tables_;
  std::vector<std::string> notes_;
};

/// Prints the report and writes the JSON, according to the options.
/// @param outputTaken  something else was written to standard output: the report goes to standard error
[[nodiscard]] Result<void> publish(const CommonOptions& options, const Report& report, bool outputTaken = false);

/// Tells a program that runs this one, such as `lorica bake`, why a command failed: writes {"failure": {"kind":
/// "badFormat", "message": ...}} to the file that LORICA_FAILURE_FILE in the environment names.
void publishFailure(std::string_view kind, std::string_view message);

/// Rejects, before any work, a --json file that cannot be written or that is one of the other files.
/// @param others  inputs and other outputs of the command; empty ones are ignored
[[nodiscard]] Result<void> checkJsonOutput(const CommonOptions& options,
                                           const std::vector<std::filesystem::path>& others);

/// Rejects an output that is one of the other files. @param others  empty ones are ignored
[[nodiscard]] Result<void> checkNotTaken(const std::string& option, const std::filesystem::path& file,
                                         const std::vector<std::filesystem::path>& others);

/// Rejects an output file before any work: its folder must exist, and it must not be there already.
/// @param option     for the error message: "--export-obj"
/// @param extension  required extension; empty = any
[[nodiscard]] Result<void> checkOutput(const CommonOptions& options, const std::string& option,
                                       const std::filesystem::path& file, const std::string& extension = "");

/// The same for a folder, which is created later if it does not exist. It may hold other files.
/// @param written  whether the command writes a file of this name in it; null = none that is not its own
[[nodiscard]] Result<void> checkOutputFolder(const CommonOptions& options, const std::string& option,
                                             const std::filesystem::path& folder,
                                             const std::function<bool(const std::string& name)>& written = nullptr);

/// Rejects, before any work, what a run cannot write. @param inputs  files that no output may overwrite
[[nodiscard]] Result<void> checkOutputs(const RunSetting& setting, const SnapshotOptions& pictures,
                                        const CommonOptions& common, std::vector<std::filesystem::path> inputs);

/// Rejects, before any work, a camera that sees nothing or a video that cannot be written.
[[nodiscard]] Result<void> checkPictures(const CommonOptions& common, const SnapshotOptions& pictures);

/// Rejects an unusable name of a recorded session before any work.
[[nodiscard]] Result<void> checkRecord(const CommonOptions& common, const std::string& option, const std::string& file);

/// Opens standard input, output and error if the program was started without them; otherwise the next file would take
/// their place, and messages would be written into it. Writing to those that were missing is an error.
void openStandardStreams();

/// Prints to standard error. What cannot be written there is dropped, for there is no other place to say so.
void say(std::string_view text);

/// Prints to standard output. @param what  for the error message: "the report"
[[nodiscard]] Result<void> print(std::string_view text, std::string_view what);

/// Prints a warning to standard error, one line: "lorica: warning: ...". The same sentence is said once in a run.
void warn(const std::string& sentence);

/// Columns of the terminal that a descriptor leads to; none if it is not a terminal.
[[nodiscard]] std::optional<int> terminalWidth(int descriptor);

}  // namespace lorica
