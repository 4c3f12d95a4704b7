#include "capture/files/joint_stream_layouts.h"
#include "capture/files/joint_stream_text.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/line_scanner.h"

#include <array>
#include <bitset>
#include <string>
#include <utility>

/// Reads OpenSim's tables of markers (.trc): lines about the recording, one with the names of the markers, one with the
/// axes of each, then rows of a frame, a time in seconds and the positions.
/// https://opensimconfluence.atlassian.net/wiki/spaces/OpenSim/pages/53089972/Marker+.trc+Files
namespace lorica::joints {
namespace {

/// What follows a column's name; empty: the body tells.
std::string_view suffixOfUnit(std::string_view unit) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kUnits = {
      {{"m meter meters metre metres", "_m"},
       {"cm centimeter centimeters centimetre centimetres", "_cm"},
       {"mm millimeter millimeters millimetre millimetres", "_mm"}}};
  const std::string plain = plainName(unit);
  for (const auto& [words, suffix] : kUnits) {
    if (!firstWord(words, [&](std::string_view word) { return word == plain; }).empty()) return suffix;
  }
  return {};
}

}  // namespace

Result<RawStream> readMarkers(const Layout& layout, std::string_view text, std::string_view file) {
  constexpr std::size_t kHeaderLines = 20;
  LineScanner lines(text, std::string(file), 0);
  std::vector<std::string> above;  // the line before, which names the values of this one
  std::string_view unit;
  std::vector<std::string> names;
  while (names.empty()) {
    if (!lines.nextLine() || lines.line() > kHeaderLines) {
      return badFormat("{}: found no line of Frame#, Time and names in the first {} lines, expected a table of markers",
                       file, kHeaderLines);
    }
    RowReader row(lines.rest(), file);
    std::vector<std::string> words;
    if (row.next()) words.assign(row.fields().begin(), row.fields().end());
    for (int i = 0; i < std::min(countOf(words), countOf(above)); ++i) {
      if (sameWord(above[i], "Units")) unit = suffixOfUnit(words[i]);
    }
    above = words;
    if (plainName(words.empty() ? "" : words[0]).starts_with("frame")) names = std::move(words);
  }
  std::erase(names, "");  // below them are y and z
  LineScanner axes = lines;
  if (axes.nextLine() && isWord(axes.rest())) lines = axes;

  // One line that names all columns, as other logs have it.
  const std::string_view rows = lines.afterLine();
  const char tab = rows.find('\t') != std::string_view::npos ? '\t' : ' ';
  std::string table(lines.line() - 1, '\n');
  table += fmt::format("frame{}time_s", tab);
  std::bitset<kSensorJointCount> named;
  for (int i = 2; i < countOf(names); ++i) {
    const std::string name = names[i].substr(names[i].rfind(':') + 1);  // behind the subject's
    const std::optional<SensorJoint> joint = sensorJointCalled(name);
    const int at = static_cast<int>(joint.value_or(SensorJoint::kOther));
    const bool again = joint && joint != SensorJoint::kOther && named[at];
    named.set(at);
    for (const char axis : {'x', 'y', 'z'}) {
      table += again ? fmt::format("{}-", tab) : fmt::format("{}{}_{}{}", tab, name, axis, unit);
    }
  }
  table += '\n';
  table += rows;
  Layout columns = layoutOf(JointFormat::kNamedColumns);
  columns.world = layout.world;
  return readNamed(columns, table, file);
}

}  // namespace lorica::joints
