#include "apps/report.h"

#include "geometry/descriptor.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/text.h"
#include "viewer/player/run.h"
#include "viewer/player/snapshots.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <algorithm>
#include <mutex>
#include <optional>
#include <set>
#include <system_error>
#include <thread>

namespace lorica {

namespace {

/// Number of characters in UTF-8 text: the bytes that are not continuation bytes.
std::size_t widthOf(const std::string& text) {
  return std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
}

constexpr std::size_t kLongestCell = 200;    // [bytes]
constexpr std::size_t kLongestValue = 4000;  // of a line: a list of bones, say [bytes]

Table shortened(const Table& table) {
  Table shown = table;
  for (std::vector<std::string>& row : shown.rows) {
    for (std::string& cell : row) cell = printable(cell, kLongestCell);
  }
  return shown;
}

void addTable(const Table& table, std::string& text) {
  std::vector<std::size_t> widths;
  widths.reserve(table.headings.size());
  for (const std::string& heading : table.headings) widths.push_back(widthOf(heading));
  for (const std::vector<std::string>& row : table.rows) {
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], widthOf(row[c]));
  }
  const auto printRow = [&](const std::vector<std::string>& row) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string space(widths[c] - widthOf(row[c]), ' ');
      line += "  " + (c >= table.textFrom ? row[c] + space : space + row[c]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  };
  text += "\n";
  printRow(table.headings);
  for (const std::vector<std::string>& row : table.rows) printRow(row);
}

/// File names may not be valid UTF-8; JSON must be.
std::string fileText(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

int CommonOptions::threadCount() const {
  return threads > 0 ? threads : std::max<int>(1, std::thread::hardware_concurrency());
}

void Facts::add(std::string json, std::string label, Json value, std::string words) {
  list_.push_back({std::move(json), std::move(label), std::move(value), std::move(words)});
}

void Facts::add(std::string json, std::string label, Json value) {
  std::string words = value.is_string()           ? value.get<std::string>()
                      : value.is_number_integer() ? grouped(value.get<std::int64_t>())
                                                  : "";
  add(std::move(json), std::move(label), std::move(value), std::move(words));
}

void Facts::line(std::string label, std::string words) {
  if (!words.empty()) add("", std::move(label), {}, std::move(words));
}

Facts Facts::textOnly() const {
  Facts same = *this;
  std::erase_if(same.list_, [](const Fact& fact) { return !fact.json.empty() && fact.words.empty(); });
  for (Fact& fact : same.list_) fact.json.clear();
  return same;
}

Facts Facts::jsonOnly() const {
  Facts same = *this;
  std::erase_if(same.list_, [](const Fact& fact) { return fact.json.empty(); });
  for (Fact& fact : same.list_) fact.words.clear();
  return same;
}

void Report::table(Table table, std::size_t most, const std::string& rows) {
  if (table.rows.size() > most) note("The table does not show all " + rows + "; --json does.");
  table.rows.resize(std::min(table.rows.size(), most));
  this->table(std::move(table));
}

std::string Report::text() const {
  const bool bold = isatty(STDOUT_FILENO) == 1 && environment("NO_COLOR").empty() && environment("TERM") != "dumb";
  std::string text = fmt::format("{}{}{}\n", bold ? "\x1b[1m" : "", printable(headline_), bold ? "\x1b[0m" : "");
  std::size_t width = 0;
  for (const Fact& fact : list()) {
    if (!fact.words.empty()) width = std::max(width, printable(fact.label, kLongestCell).size());
  }
  for (const Fact& fact : list()) {
    if (!fact.words.empty()) {
      text += fmt::format("  {:<{}}  {}\n", printable(fact.label, kLongestCell), width,
                          printable(fact.words, kLongestValue));
    } else if (fact.json.empty()) {
      text += "\n";
    }
  }
  for (const Table& table : tables_) addTable(shortened(table), text);
  for (const std::string& note : notes_) text += fmt::format("\n  {}\n", printable(note));
  return text;
}

Json Report::json() const {
  std::vector<const Fact*> named;
  for (const Fact& fact : list()) {
    if (!fact.json.empty()) named.push_back(&fact);
  }
  const auto place = [first = " " + order_ + " "](const Fact* fact) { return first.find(" " + fact->json + " "); };
  std::ranges::stable_sort(named, {}, place);
  Json json = Json::object();
  for (const Fact* fact : named) json[fact->json] = fact->value;
  return json;
}

Result<void> publish(const CommonOptions& options, const Report& report, bool outputTaken) {
  const std::string text = fileText(report.json());
  if (options.json == "-") return print(text, "the JSON");
  if (!options.json.empty()) LORICA_TRY_DO(writeFileAtomically(options.json, text));
  if (!outputTaken) return print(report.text(), "the report");
  say(report.text());
  return {};
}

void publishFailure(std::string_view kind, std::string_view message) {
  const std::string file = environment("LORICA_FAILURE_FILE");
  if (file.empty()) return;
  const Json json = {{"failure", {{"kind", kind}, {"message", message}}}};
  (void)writeFileAtomically(file, fileText(json));  // who cannot be told so reads the sentence
}

Result<void> checkNotTaken(const std::string& option, const std::filesystem::path& file,
                           const std::vector<std::filesystem::path>& others) {
  if (file.empty()) return {};
  std::error_code ignored;
  const std::filesystem::path meant = std::filesystem::weakly_canonical(file, ignored);
  for (const std::filesystem::path& other : others) {
    if (other.empty() || std::filesystem::weakly_canonical(other, ignored) != meant) continue;
    return invalidArgument("{}: {} is also an input or another output and would be overwritten", option, file.string());
  }
  return {};
}

namespace {

/// Rejects a file of text that cannot be written or that is one of the others. @param file  "-" = standard output
Result<void> checkText(const CommonOptions& options, const std::string& option, const std::filesystem::path& file,
                       const std::vector<std::filesystem::path>& others) {
  if (file.empty() || file == "-") return {};
  LORICA_TRY_DO(checkNotTaken(option, file, others));
  std::error_code ignored;
  if (std::filesystem::exists(file, ignored) && !std::filesystem::is_directory(file, ignored) &&
      !std::filesystem::is_regular_file(file, ignored)) {
    return unwritable("{}: {} is not a regular file; `{} -` writes to standard output", option, file.string(), option);
  }
  return checkOutput(options, option, file);
}

}  // namespace

Result<void> checkJsonOutput(const CommonOptions& options, const std::vector<std::filesystem::path>& others) {
  return checkText(options, "--json", options.json, others);
}

Result<void> checkOutput(const CommonOptions& options, const std::string& option, const std::filesystem::path& file,
                         const std::string& extension) {
  std::error_code ignored;
  if (!extension.empty() && file.extension() != extension) {
    return invalidArgument("{}: {}: expected a name that ends in {}", option, file.string(), extension);
  }
  if (std::filesystem::is_directory(file, ignored)) {
    return unwritable("{}: {} is a folder, expected a file", option, file.string());
  }
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  if (!std::filesystem::is_directory(folder, ignored)) {
    return unwritable("{}: {}: no such folder: {}", option, file.string(), folder.string());
  }
  if (access(folder.c_str(), W_OK) != 0) {
    return unwritable("{}: {}: the folder {} is not writable", option, file.string(), folder.string());
  }
  if (options.force || !std::filesystem::is_regular_file(file, ignored)) return {};
  return unwritable("{}: {} exists and would be overwritten, which --force allows", option, file.string());
}

Result<void> checkOutputFolder(const CommonOptions& options, const std::string& option,
                               const std::filesystem::path& folder,
                               const std::function<bool(const std::string& name)>& written) {
  // Check the nearest existing ancestor.
  std::error_code ignored;
  std::filesystem::path nearest = std::filesystem::absolute(folder, ignored).lexically_normal();
  while (!std::filesystem::exists(nearest, ignored) && nearest.has_relative_path()) nearest = nearest.parent_path();
  if (!std::filesystem::is_directory(nearest, ignored)) {
    return unwritable("{}: {}: {} is a file, expected a folder", option, folder.string(), nearest.string());
  }
  if (access(nearest.c_str(), W_OK) != 0) {
    return unwritable("{}: {}: the folder {} is not writable", option, folder.string(), nearest.string());
  }
  if (written == nullptr) return {};
  for (const std::filesystem::directory_entry& there : std::filesystem::directory_iterator(folder, ignored)) {
    if (written(there.path().filename().string())) LORICA_TRY_DO(checkOutput(options, option, there.path()));
  }
  return {};
}

Result<void> checkPictures(const CommonOptions& common, const SnapshotOptions& pictures) {
  const std::optional<Vec3>&eye = pictures.camera.eye, &target = pictures.camera.target;
  if (eye && target && (*eye - *target).norm() < 1e-3) {
    return invalidArgument("--eye {} --target {}: expected two positions at least 1 mm apart", fmt::join(*eye, ","),
                           fmt::join(*target, ","));
  }
  if (pictures.video.empty()) return {};
  if (std::filesystem::path(pictures.video).extension() != ".mp4") {
    return invalidArgument("--video {}: films are MP4 files, expected a name that ends in .mp4", pictures.video);
  }
  const CanvasSize size = pictures.size;
  if (size.width % 2 != 0 || size.height % 2 != 0) {
    return invalidArgument("--size {}x{}: width and height of an .mp4 video must be even", size.width, size.height);
  }
  if (pictures.transparent()) {
    return invalidArgument(
        "--video: films are not transparent, expected --background with a colour such as green; `lorica play ... "
        "--background transparent --snapshots DIR --every 1` makes a picture of each frame");
  }
  return checkOutput(common, "--video", pictures.video);
}

Result<void> checkRecord(const CommonOptions& common, const std::string& option, const std::string& file) {
  return file.empty() ? Result<void>() : checkOutput(common, option, file, ".lsession");
}

namespace {

Result<void> checkSnapshots(const SnapshotOptions& options, const CommonOptions& common) {
  if (!options.any() && (!options.camera.preset.empty() || options.camera.eye)) {
    return invalidArgument("--camera and --eye have no effect without pictures: expected --snapshots or --video");
  }
  if (!options.folder.empty()) {
    LORICA_TRY_DO(checkOutputFolder(common, "--snapshots", options.folder,
                                    [&](const std::string& name) { return options.draws(name); }));
  }
  return checkPictures(common, options);
}

}  // namespace

Result<void> checkOutputs(const RunSetting& setting, const SnapshotOptions& pictures, const CommonOptions& common,
                          std::vector<std::filesystem::path> inputs) {
  LORICA_TRY_DO(checkJsonOutput(common, inputs));
  LORICA_TRY_DO(checkSnapshots(pictures, common));
  LORICA_TRY_DO(checkRecord(common, "--record", setting.record));
  LORICA_TRY_DO(checkNotTaken("--record", setting.record, inputs));
  if (setting.events == "-" && common.json == "-") {
    return invalidArgument("--events and --json cannot both use standard output: give a file for one of them");
  }
  inputs.emplace_back(setting.record);
  if (common.json != "-") inputs.emplace_back(common.json);
  return checkText(common, "--events", setting.events, inputs);
}

void openStandardStreams() {
  // The lowest free number is used, which is that of the missing stream.
  int descriptor = 0;
  while (descriptor <= STDERR_FILENO) {
    descriptor = ::open("/dev/null", O_RDONLY);
    if (descriptor < 0) return;
  }
  ::close(descriptor);
}

void say(std::string_view text) {
  (void)writeAll(STDERR_FILENO, text);
}

Result<void> print(std::string_view text, std::string_view what) {
  const int error = writeAll(STDOUT_FILENO, text);
  if (error == 0) return {};
  return unwritable("standard output: could not write {}: {}", what, std::generic_category().message(error));
}

void warn(const std::string& sentence) {
  static std::mutex busy;
  static std::set<std::string> said;
  const std::lock_guard<std::mutex> lock(busy);
  if (said.insert(sentence).second) say(fmt::format("lorica: warning: {}\n", printable(sentence)));
}

std::optional<int> terminalWidth(int descriptor) {
  winsize size = {};
  if (ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return std::nullopt;
}

}  // namespace lorica
