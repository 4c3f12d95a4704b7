#pragma once

#include "geometry/result.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace lorica {

/// Options that every subcommand has.
struct CommonOptions {
  std::string json;  ///< file for the report as JSON; "-" = standard output and nothing else there; empty = none
  int threads = 0;   ///< 0 = as many as the machine has

  /// What --threads comes to on this machine.
  [[nodiscard]] int threadCount() const;
};

/// Rows of words under headings. Columns are as wide as they need to be; numbers stand to the right.
struct Table {
  std::vector<std::string> headings;
  std::vector<std::vector<std::string>> rows;  ///< as many words as there are headings
  std::size_t textFrom = std::string::npos;    ///< columns from this one on hold text, which stands to the left
};

/// What a person reads at the end: a headline, then lines of label and value in aligned columns, then tables, then
/// notes.
class Report {
 public:
  explicit Report(std::string headline) : headline_(std::move(headline)) {}

  void line(std::string label, std::string value) { lines_.emplace_back(std::move(label), std::move(value)); }
  void gap() { lines_.emplace_back(); }
  void table(Table table) { tables_.push_back(std::move(table)); }
  /// A sentence after everything else.
  void note(std::string sentence) { notes_.push_back(std::move(sentence)); }
  /// To standard output; headline in bold in a terminal unless NO_COLOR is set.
  void print() const;

 private:
  std::string headline_;
  std::vector<std::pair<std::string, std::string>> lines_;
  std::vector<Table> tables_;
  std::vector<std::string> notes_;
};

/// Prints the report and writes the JSON, as the options say.
[[nodiscard]] Result<void> publish(const CommonOptions& options, const Report& report,
                                   const nlohmann::ordered_json& json);

/// Refuses, before any work is done, a --json that cannot be written or that names one of the other files.
/// @param others  inputs and further outputs of the command; empty ones do not count
[[nodiscard]] Result<void> checkJsonOutput(const CommonOptions& options,
                                           const std::vector<std::filesystem::path>& others);

/// Fails early, before minutes of work: the output's folder must be there, and the output must not be a folder.
/// @param option     named in the sentence: "--export-obj"
/// @param extension  that the name must have; empty = any
[[nodiscard]] Result<void> checkOutput(const std::string& option, const std::filesystem::path& file,
                                       const std::string& extension = "");

/// The same for a folder that will be made where it is not there yet.
[[nodiscard]] Result<void> checkOutputFolder(const std::string& option, const std::filesystem::path& folder);

/// A remark on standard error, one line: "lorica: warning: ...".
void warn(const std::string& sentence);

/// An environment variable; empty when it is not set.
[[nodiscard]] std::string environment(const char* name);

/// Columns of the terminal behind a stream; 80 where there is none.
[[nodiscard]] int terminalWidth(std::FILE* stream);

/// A to Z as a to z.
[[nodiscard]] std::string lowerCase(std::string text);

/// 12345 as "12,345".
[[nodiscard]] std::string grouped(long long number);

/// A number, or a count with its noun: "1 part", "12 parts".
[[nodiscard]] std::string counted(long long number, const std::string& noun, const std::string& plural = "");

/// 0.1234 as "12.3 %".
[[nodiscard]] std::string percent(double fraction);

/// Metres as "1.25 mm".
[[nodiscard]] std::string millimetres(double metres);

/// Microseconds as "85 us", "1.25 ms" or "2.3 s".
[[nodiscard]] std::string duration(double microseconds);

}  // namespace lorica
