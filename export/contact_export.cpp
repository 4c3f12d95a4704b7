#include "export/contact_export.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/little_endian.h"
#include "geometry/new_file.h"
#include "geometry/text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <map>
#include <memory>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr double kFarthest = 1.0;           // that `near` may be [m]
constexpr double kFloats = 0.05;            // a body that stays higher never meets the floor [m]
constexpr double kSinks = 0.2;              // one that goes deeper has another floor [m]
constexpr std::size_t kWritten = 1U << 16;  // bytes of rows that are written at a time

constexpr std::array<const char*, 4> kKinds = {"floor", "prop", "self", "avatars"};
constexpr std::array<const char*, 3> kFeet = {"", "left", "right"};
constexpr std::array<const char*, 3> kPhases = {"", "swing", "stance"};

/// A column of the table. Numbers of several words have a column each in .csv.
struct Column {
  enum Type { kDouble, kFloat, kVector, kIndex, kBone, kWord } type;
  const char* name;
  std::size_t offset;
  std::span<const char* const> words = {};
};

const std::array<Column, 18> kColumns = {{
    {Column::kIndex, "frame", offsetof(ContactRow, frame)},
    {Column::kDouble, "time", offsetof(ContactRow, time)},
    {Column::kWord, "kind", offsetof(ContactRow, kind), kKinds},
    {Column::kIndex, "avatar", offsetof(ContactRow, avatar)},
    {Column::kIndex, "part", offsetof(ContactRow, part)},
    {Column::kBone, "bone", offsetof(ContactRow, bone)},
    {Column::kIndex, "other_avatar", offsetof(ContactRow, otherAvatar)},
    {Column::kIndex, "other_part", offsetof(ContactRow, otherPart)},
    {Column::kBone, "other_bone", offsetof(ContactRow, otherBone)},
    {Column::kIndex, "prop", offsetof(ContactRow, prop)},
    {Column::kFloat, "depth", offsetof(ContactRow, depth)},
    {Column::kVector, "point", offsetof(ContactRow, point)},
    {Column::kVector, "normal", offsetof(ContactRow, normal)},
    {Column::kVector, "velocity", offsetof(ContactRow, velocity)},
    {Column::kFloat, "strength", offsetof(ContactRow, strength)},
    {Column::kFloat, "slip", offsetof(ContactRow, slip)},
    {Column::kWord, "foot", offsetof(ContactRow, foot), kFeet},
    {Column::kWord, "phase", offsetof(ContactRow, phase), kPhases},
}};

template <typename T>
T at(const ContactRow& row, std::size_t offset) {
  T value;
  std::memcpy(&value, reinterpret_cast<const char*>(&row) + offset, sizeof(T));
  return value;
}

/// Text in quotes, and without bytes that are no UTF-8.
std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}
std::string utf8Of(const std::string& text) {
  return nlohmann::json::parse(quoted(text));
}

/// A name as a cell of .csv: in quotes if it has to be.
std::string cellOf(const std::string& name) {
  if (name.find_first_of(",\"\n\r") == std::string::npos) return name;
  std::string cell = "\"";
  for (const char letter : name) cell += letter == '"' ? std::string("\"\"") : std::string(1, letter);
  return cell + "\"";
}

/// A line of .csv or .jsonl, appended. @param json  else values are separated by commas
void addLine(const ContactRow& row, std::span<const std::string> bones, bool json, fmt::memory_buffer& text) {
  const auto out = std::back_inserter(text);
  char before = json ? '{' : '\0';
  for (const Column& column : kColumns) {
    if (before != '\0') text.push_back(before);
    before = ',';
    if (json) fmt::format_to(out, "\"{}\":", column.name);
    const char* nothing = json ? "null" : "";
    switch (column.type) {
      case Column::kDouble:
        fmt::format_to(out, "{}", at<double>(row, column.offset));
        break;
      case Column::kFloat:
        fmt::format_to(out, "{:.6g}", at<float>(row, column.offset));
        break;
      case Column::kVector: {
        const auto v = at<std::array<float, 3>>(row, column.offset);
        fmt::format_to(out, "{}{:.6g},{:.6g},{:.6g}{}", json ? "[" : "", v[0], v[1], v[2], json ? "]" : "");
        break;
      }
      case Column::kIndex:
      case Column::kBone: {
        const auto index = at<std::int32_t>(row, column.offset);
        if (index < 0) {
          fmt::format_to(out, "{}", nothing);
        } else if (column.type != Column::kBone) {
          fmt::format_to(out, "{}", index);
        } else {
          const std::string& name = bones[static_cast<std::size_t>(index)];
          fmt::format_to(out, "{}", json ? quoted(name) : cellOf(name));
        }
        break;
      }
      case Column::kWord: {
        const char* word = column.words[at<std::uint8_t>(row, column.offset)];
        const char* quote = json && *word != '\0' ? "\"" : "";
        fmt::format_to(out, "{}{}{}", quote, *word != '\0' ? word : nothing, quote);
        break;
      }
    }
  }
  fmt::format_to(out, "{}\n", json ? "}" : "");
}

std::string headings() {
  std::string line;
  for (const Column& column : kColumns) {
    for (const char* axis : {"_x", "_y", "_z"}) {
      const bool vector = column.type == Column::kVector;
      line += fmt::format("{}{}{}", line.empty() ? "" : ",", column.name, vector ? axis : "");
      if (!vector) break;
    }
  }
  return line + "\n";
}

/// The names of all bones of a session's avatars, each once.
class BoneNames {
 public:
  BoneNames(const Session& session, std::vector<std::string>& names) {
    std::map<std::string, std::int32_t> known;
    for (const SessionAvatar& avatar : session.avatars()) {
      std::vector<std::int32_t>& indices = indices_.emplace_back();
      for (const Joint& joint : avatar.character().skeleton.joints()) {
        const auto [found, added] = known.emplace(utf8Of(joint.name), countOf(names));
        if (added) names.push_back(found->first);
        indices.push_back(found->second);
      }
    }
  }
  [[nodiscard]] std::int32_t of(std::int32_t avatar, std::int32_t joint) const {
    return joint == kNoJoint ? -1 : indices_[static_cast<std::size_t>(avatar)][static_cast<std::size_t>(joint)];
  }

 private:
  std::vector<std::vector<std::int32_t>> indices_;
};

/// What a user should know before trusting labels of feet.
void addNotes(const Session& session, const ContactTable& table, std::vector<std::string>& notes) {
  if (!session.world().hasFloor()) notes.emplace_back("the scene has no floor: found no contacts with one");
  for (int a = 0; a < countOf(session.avatars()); ++a) {
    const Skeleton& skeleton = session.avatar(a).character().skeleton;
    const auto isFoot = [](const Joint& joint) {
      return joint.bone == HumanBone::kLeftFoot || joint.bone == HumanBone::kRightFoot;
    };
    if (std::ranges::none_of(skeleton.joints(), isFoot)) {
      notes.push_back(fmt::format("avatar {}: no bone is known as a foot, so no foot stands", a));
    }
    const double lowest = table.lowest(a);
    if (!session.world().hasFloor() || lowest == kInfinity) continue;
    if (lowest > kFloats) {
      notes.push_back(fmt::format(
          "avatar {}: stays {:.2f} m above the floor, expected a motion whose floor is y = 0: no foot stands", a,
          lowest));
    } else if (lowest < -kSinks) {
      notes.push_back(
          fmt::format("avatar {}: goes {:.2f} m below the floor, expected a motion whose floor is y = 0", a, -lowest));
    }
  }
}

template <typename T>
void append(const ContactLabels& labels, std::size_t offset, std::string& bytes) {
  for (const ContactRow& row : labels.rows) appendLittleEndian(at<T>(row, offset), bytes);
}

NamedArray arrayOf(const ContactLabels& labels, const Column& column) {
  NamedArray array{column.name, "<i4", {labels.rows.size()}, {}};
  switch (column.type) {
    case Column::kDouble:
      array.type = "<f8";
      append<double>(labels, column.offset, array.bytes);
      break;
    case Column::kFloat:
      array.type = "<f4";
      append<float>(labels, column.offset, array.bytes);
      break;
    case Column::kVector:
      array.type = "<f4";
      array.shape.push_back(3);
      for (const ContactRow& row : labels.rows) {
        for (const float v : at<std::array<float, 3>>(row, column.offset)) appendLittleEndian(v, array.bytes);
      }
      break;
    case Column::kWord:
      array.type = "|u1";
      append<std::uint8_t>(labels, column.offset, array.bytes);
      break;
    case Column::kIndex:
    case Column::kBone:
      append<std::int32_t>(labels, column.offset, array.bytes);
      break;
  }
  return array;
}

template <typename Words>
NamedArray arrayOf(const char* name, const Words& words) {
  std::vector<std::u32string> texts;
  std::size_t longest = 1;
  for (const auto& word : words) {
    texts.push_back(fs::path(reinterpret_cast<const char8_t*>(utf8Of(word).c_str())).u32string());
    longest = std::max(longest, texts.back().size());
  }
  NamedArray array{name, fmt::format("<U{}", longest), {texts.size()}, {}};
  for (std::u32string& text : texts) {
    text.resize(longest, U'\0');
    for (const char32_t letter : text) appendLittleEndian(static_cast<std::uint32_t>(letter), array.bytes);
  }
  return array;
}

}  // namespace

Result<ContactLabels> findContacts(
    const ContactRequest& request, Host& host,
    const std::function<Result<void>(const ContactRow& row, std::span<const std::string> bones)>& take) {
  if (!(request.near >= 0.0 && request.near <= kFarthest)) {
    return invalidArgument("near: found {} m, expected 0 to {:g} m", request.near, kFarthest);
  }
  LORICA_TRY(Cast cast, prepareCast(request.cast, host));
  if (cast.request.scene.empty()) {
    cast.world = World();
    addProps(cast.added, cast.world);
  }
  ContactLabels labels;
  labels.name = cast.name;
  labels.avatars = cast.avatars.size();
  int expected = 0;
  for (const PreparedAvatar& avatar : cast.avatars) {
    expected = std::max(expected, avatar.motion->frameCount());
    labels.notes.insert(labels.notes.end(), avatar.motion->notes.begin(), avatar.motion->notes.end());
  }
  LORICA_TRY(Session session, startSession(cast));
  ContactTable table(session, request.near);
  const BoneNames names(session, labels.bones);
  Task task(host, "Finding contacts of " + labels.name, "frames");
  while (true) {
    if (task.cancelled()) return cancelled();
    LORICA_TRY(const bool more, session.step());
    if (!more) break;
    const std::span<const ContactRow> found = table.update(session);
    labels.rowCount += found.size();
    if (labels.rowCount > request.mostRows) {
      return invalidArgument(
          "{}: found more than {} rows in {} of {} frames, expected at most that: a part of the motion, or a shorter "
          "--near",
          labels.name, grouped(static_cast<long long>(request.mostRows)), session.frameCount(), expected);
    }
    for (ContactRow row : found) {
      row.bone = names.of(row.avatar, row.bone);
      row.otherBone = names.of(row.otherAvatar, row.otherBone);
      if (row.depth > 0.0F) ++labels.overlaps;
      if (take) {
        LORICA_TRY_DO(take(row, labels.bones));
      } else {
        labels.rows.push_back(row);
      }
    }
    labels.times.push_back(session.time());
    for (int a = 0; a < countOf(session.avatars()); ++a) {
      for (const bool stands : table.standing(a)) labels.standing.push_back(stands ? 1 : 0);
    }
    task.update(session.frameCount(), std::max(expected, session.frameCount()));
  }
  addNotes(session, table, labels.notes);
  return labels;
}

Result<void> forEachArray(const ContactLabels& labels,
                          const std::function<Result<void>(const NamedArray& array)>& visit) {
  for (const Column& column : kColumns) LORICA_TRY_DO(visit(arrayOf(labels, column)));
  NamedArray times{"frame_time", "<f8", {labels.times.size()}, {}};
  for (const double time : labels.times) appendLittleEndian(time, times.bytes);
  LORICA_TRY_DO(visit(times));
  LORICA_TRY_DO(visit({"frame_standing",
                       "|b1",
                       {labels.times.size(), labels.avatars, 2},
                       std::string(labels.standing.begin(), labels.standing.end())}));
  LORICA_TRY_DO(visit(arrayOf("bones", labels.bones)));
  LORICA_TRY_DO(visit(arrayOf("kinds", kKinds)));
  LORICA_TRY_DO(visit(arrayOf("feet", kFeet)));
  LORICA_TRY_DO(visit(arrayOf("phases", kPhases)));
  return visit(arrayOf("notes", labels.notes));
}

Result<ContactLabels> writeContacts(const ContactRequest& request, const std::string& file, Host& host) {
  const std::string extension = lowerCase(fs::path(file).extension().string());
  const bool json = extension == ".jsonl";
  if (extension != ".npz" && extension != ".csv" && !json) {
    return invalidArgument("{}: found the extension `{}`, expected .npz (numpy), .csv or .jsonl", file, extension);
  }
  LORICA_TRY(const std::unique_ptr<NewFile> out, NewFile::create(file));
  if (extension == ".npz") {
    LORICA_TRY(ContactLabels labels, findContacts(request, host));
    std::vector<NamedArray> arrays;
    LORICA_TRY_DO(forEachArray(labels, [&](NamedArray array) {
      arrays.push_back(std::move(array));
      return Result<void>();
    }));
    labels.rows = {};
    LORICA_TRY_DO(writeArrays(arrays, *out));
    LORICA_TRY_DO(out->finish());
    return labels;
  }
  if (!json) LORICA_TRY_DO(out->write(headings()));
  fmt::memory_buffer text;
  const auto flush = [&] {
    const Result<void> written = out->write({text.data(), text.size()});
    text.clear();
    return written;
  };
  LORICA_TRY(
      ContactLabels labels,
      findContacts(request, host, [&](const ContactRow& row, std::span<const std::string> bones) -> Result<void> {
        addLine(row, bones, json, text);
        return text.size() < kWritten ? Result<void>() : flush();
      }));
  LORICA_TRY_DO(flush());
  LORICA_TRY_DO(out->finish());
  return labels;
}

}  // namespace lorica
