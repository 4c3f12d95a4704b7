#include "capture/files/joint_stream_layouts.h"

#include "capture/files/joint_stream_text.h"
#include "geometry/counts.h"
#include "geometry/errors.h"

#include <algorithm>
#include <cmath>
#include <utility>

/// The table of layouts, what only a whole file of one tells, and the detection of a file's layout.
namespace lorica::joints {
namespace {

using enum SensorJoint;

constexpr std::array<SensorJoint, kKinect1JointCount> kKinect1Order = {
    kSpineBase, kSpineMid,      kSpineShoulder, kHead,       kShoulderLeft, kElbowLeft, kWristLeft,
    kHandLeft,  kShoulderRight, kElbowRight,    kWristRight, kHandRight,    kHipLeft,   kKneeLeft,
    kAnkleLeft, kFootLeft,      kHipRight,      kKneeRight,  kAnkleRight,   kFootRight};
constexpr std::array<SensorJoint, 25> kKinect2Order = [] {
  std::array<SensorJoint, 25> order{};
  for (int j = 0; j < 25; ++j) order[j] = static_cast<SensorJoint>(j);
  return order;
}();
constexpr std::array<SensorJoint, kKinect1JointCount> kMsrOrder = {
    kShoulderLeft, kShoulderRight, kSpineShoulder, kSpineMid,   kHipLeft,   kHipRight,  kSpineBase,
    kElbowLeft,    kElbowRight,    kWristLeft,     kWristRight, kHandLeft,  kHandRight, kKneeLeft,
    kKneeRight,    kAnkleLeft,     kAnkleRight,    kFootLeft,   kFootRight, kHead};
constexpr std::array<SensorJoint, 6> kArmsOrder = {kShoulderLeft,  kElbowLeft,  kHandLeft,
                                                   kShoulderRight, kElbowRight, kHandRight};
/// Waist, spine, chest, neck, head, head tip; left collar, upper arm, forearm, hand; the same on the right; left upper
/// leg, lower leg, foot, toes; the same on the right.
constexpr std::array<SensorJoint, 22> kUiPrmdOrder = {
    kSpineBase, kSpineMid, kOther,    kNeck,          kHead,       kOther,     kOther,   kShoulderLeft,
    kElbowLeft, kHandLeft, kOther,    kShoulderRight, kElbowRight, kHandRight, kHipLeft, kKneeLeft,
    kAnkleLeft, kFootLeft, kHipRight, kKneeRight,     kAnkleRight, kFootRight};

constexpr std::array<SensorJoint, 32> kAzureOrder = {
    kSpineBase,    kSpineMid,    kSpineShoulder, kNeck,     kOther,         kShoulderLeft, kElbowLeft,  kWristLeft,
    kHandLeft,     kHandTipLeft, kThumbLeft,     kOther,    kShoulderRight, kElbowRight,   kWristRight, kHandRight,
    kHandTipRight, kThumbRight,  kHipLeft,       kKneeLeft, kAnkleLeft,     kFootLeft,     kHipRight,   kKneeRight,
    kAnkleRight,   kFootRight,   kHead,          kNose,     kOther,         kEarLeft,      kOther,      kEarRight};
constexpr std::array<SensorJoint, 33> kMediaPipeOrder = {
    kNose,       kOther,      kOther,      kOther,     kOther,        kOther,         kOther,
    kEarLeft,    kEarRight,   kOther,      kOther,     kShoulderLeft, kShoulderRight, kElbowLeft,
    kElbowRight, kWristLeft,  kWristRight, kPinkyLeft, kPinkyRight,   kIndexLeft,     kIndexRight,
    kThumbLeft,  kThumbRight, kHipLeft,    kHipRight,  kKneeLeft,     kKneeRight,     kAnkleLeft,
    kAnkleRight, kOther,      kOther,      kFootLeft,  kFootRight};

/// UTKinect's recorder counted the images of both cameras, 60 per second, and so wrote only even numbers.
void assumeRate(RawStream& raw) {
  const bool allEven = std::all_of(raw.rows.begin(), raw.rows.end(),
                                   [](const Observation& row) { return std::fmod(row.frame.time, 2.0) == 0.0; });
  const double rate = allEven && raw.rows.size() > 1 ? 60.0 : 30.0;
  raw.secondsPerTick = 1.0 / rate;
  raw.notes.push_back(fmt::format("Frame numbers were assumed to count {:g} per second{}.", rate,
                                  rate == 60.0 ? ", because none is odd" : ""));
}

/// There is no other cue: for a person facing the sensor, the right arm is on the sensor's left.
void tellArmsApart(RawStream& raw) {
  double firstIsRight = 0.0;  // sum over frames of the first shoulder's offset to the sensor's left
  for (const Observation& row : raw.rows) {
    const TrackedJoint& first = row.frame[BodyJoint::kLeftShoulder];
    const TrackedJoint& second = row.frame[BodyJoint::kRightShoulder];
    if (first.confidence > 0.0 && second.confidence > 0.0) firstIsRight += first.position.x() - second.position.x();
  }
  const bool swap = firstIsRight > 0.0;
  raw.notes.push_back(
      fmt::format("The {} arm of each row is used as the left one: the person is assumed to face the sensor.",
                  swap ? "second" : "first"));
  for (Observation& row : raw.rows) {
    for (const BodyJoint left : {BodyJoint::kLeftShoulder, BodyJoint::kLeftElbow, BodyJoint::kLeftHand}) {
      if (swap) std::swap(row.frame[left], row.frame[rightOf(left)]);
    }
  }
}

/// NiTE writes millimetres. In metres a person is never 20 units away; in millimetres never that close.
void tellMetres(RawStream& raw) {
  constexpr double kLargestInMetres = 20.0;
  double largest = 0.0;
  for (const Observation& row : raw.rows) {
    for (const TrackedJoint& joint : row.frame.joints) {
      largest = std::max(largest, joint.position.cwiseAbs().maxCoeff());
    }
  }
  if (!(largest > 0.0 && largest * 1000.0 < kLargestInMetres)) return;
  raw.unit = "metres, since all numbers are below 20";
  for (Observation& row : raw.rows) {
    for (TrackedJoint& joint : row.frame.joints) joint.position *= 1000.0;
  }
}

std::string jointNumber(int joint) {
  return fmt::format("joint {}", joint + 1);
}
std::string jointNumberOfFrame(int joint) {
  return fmt::format("joint {} of the frame,", joint + 1);
}
std::string jointOfArm(int joint) {
  constexpr std::array<std::string_view, 3> kNames = {"shoulder", "elbow", "hand"};
  return fmt::format("arm {}, {}", joint / 3 + 1, kNames[joint % 3]);
}
std::string jointOfNite(int joint) {
  return std::string(nameOf(static_cast<BodyJoint>(joint)));
}

constexpr std::string_view kThirtyPerSecond = "The file has no times: 30 frames per second were assumed.";

constexpr std::array<Layout, kJointFormatCount> kLayouts = {{
    {.format = JointFormat::kLorica, .name = "lorica"},
    {.format = JointFormat::kMsrAction3d,
     .name = "msr-action3d",
     .fields = "xyzc",
     .order = kMsrOrder,
     .rowsPerFrame = kKinect1JointCount,
     .tick = 1.0 / 15.0,
     .note = "The file has no times: 15 frames per second were assumed, the rate of MSR Action3D.",
     .expectedRow = "4: x y z confidence of a joint, 20 rows per frame",
     .expectedFile = "20 rows of x y z confidence for each frame",
     .called = jointNumberOfFrame,
     .read = readRows},
    {.format = JointFormat::kUtKinect,
     .name = "utkinect",
     .before = "n",
     .fields = "xyz",
     .order = kKinect1Order,
     .expectedRow = "61: the frame number and 20 x (x y z)",
     .expectedFile = "rows of a frame number and 20 x (x y z)",
     .called = jointNumber,
     .read = readRows,
     .repair = assumeRate},
    {.format = JointFormat::kKinect2Bodies,
     .name = "kinect2-bodies",
     .fields = "sxyz",
     .order = kKinect2Order,
     .tick = 1e-7,
     .states = "0, 1 or 2",
     .called = jointNumber,
     .read = readBodies},
    {.format = JointFormat::kKinect2Wide,
     .name = "kinect2-wide",
     .states = "TRACKED, INFERRED or NOTTRACKED",
     .expectedFile = "at least one",
     .read = readNamed},
    {.format = JointFormat::kKinect1Long,
     .name = "kinect1-long",
     .states = "Tracked, Inferred or NotTracked",
     .expectedFile = "rows of Time, JointType, X, Y, Z",
     .read = readNamed},
    {.format = JointFormat::kKinect2Plain,
     .name = "kinect2-plain",
     .fields = "xyz",
     .order = kKinect2Order,
     .tick = 1.0 / 30.0,
     .note = kThirtyPerSecond,
     .expectedRow = "75: 25 x (x y z)",
     .expectedFile = "rows of 25 x (x y z)",
     .called = jointNumber,
     .read = readRows},
    {.format = JointFormat::kUiPrmd,
     .name = "ui-prmd",
     .fields = "xyz",
     .order = kUiPrmdOrder,
     .unit = 0.01,
     .tick = 1.0 / 30.0,
     .note = "The file has no times: 30 frames per second were assumed, the rate of UI-PRMD.",
     .expectedRow = "66: 22 x (x y z)",
     .expectedFile = "rows of 22 x (x y z)",
     .called = jointNumber},
    {.format = JointFormat::kUpperBody,
     .name = "upper-body",
     .fields = "xyz",
     .order = kArmsOrder,
     .tick = 1.0 / 30.0,
     .note = kThirtyPerSecond,
     .expectedRow = "18: (shoulder, elbow, hand) x 2, each x y z",
     .expectedFile = "rows of (shoulder, elbow, hand) x 2, each x y z",
     .called = jointOfArm,
     .read = readRows,
     .repair = tellArmsApart},
    {.format = JointFormat::kNite2,
     .name = "nite2",
     .before = "tu",
     .fields = "xyzc",
     .more = "qqqq",
     .order = kBodyOrder,
     .unit = 0.001,
     .expectedRow = "62: time, user, 15 x (x y z confidence)",
     .expectedRowWithMore = "62 or 122: time, user, 15 x (x y z confidence [qx qy qz qw])",
     .expectedFile = "rows of time, user, 15 x (x y z confidence)",
     .called = jointOfNite,
     .read = readRows,
     .repair = tellMetres},
    {.format = JointFormat::kNamedColumns,
     .name = "named-columns",
     .states = "a confidence from 0 to 1 or 100, or a state of 0, 1 or 2",
     .expectedFile = "at least one",
     .read = readNamed},
    {.format = JointFormat::kAzureJson, .name = "azure-json", .read = readAzureJson},
    {.format = JointFormat::kMediaPipeJson, .name = "mediapipe-json", .read = readMediaPipeJson},
    {.format = JointFormat::kTrc, .name = "trc", .world = true, .read = readMarkers},
}};

/// Rows to inspect: enough for one frame of MSR Action3D.
constexpr int kRowsLookedAt = kKinect1JointCount;

/// Kinds of headers.
std::optional<JointFormat> formatOfHeader(const RowReader& reader) {
  const auto fields = reader.fields();
  // Two of the three suffice: the format's own reader reports better what is wrong with the third.
  if (fields.size() > 5 &&
      sameWord(fields[0], "time") + sameWord(fields[1], "user") + sameWord(fields[2], "head.x") >= 2) {
    return sameWord(fields[5], "head.qx") ? JointFormat::kLorica : JointFormat::kNite2;
  }
  return kindOfHeader(reader);
}

/// Whether the row has the form "sec|kb,time,6,25,..."
bool isBodyRow(const RowReader& reader) {
  if (reader.delimiter() == Delimiter::kBlanks || reader.count() < 5) return false;
  const std::string_view tag = reader.field(0);
  if (tag.find('|') != std::string_view::npos) return true;
  const std::string_view bodies = reader.field(2);
  return bodies.size() == 1 && bodies[0] >= '1' && bodies[0] <= '6' && reader.field(3) == "25";
}

/// Whether the fields of a row may be a layout's: numbers, with whole numbers and confidences where they should be.
bool fits(const Layout& layout, RowReader& row) {
  const bool withMore = !row.fit(layout.count());
  if (withMore && (layout.more.empty() || !row.fit(layout.count(true)))) return false;
  const std::string joint = std::string(layout.fields) + std::string(withMore ? layout.more : "");
  for (int c = 0; c < row.count(); ++c) {
    const int inJoint = c - countOf(layout.before);
    const char field = inJoint < 0 ? layout.before[c] : joint[inJoint % countOf(joint)];
    double value = 0.0;
    const NumberKind kind = readNumber(row.field(c), value);
    if (kind == NumberKind::kBad) return false;
    if (field == 'n' && !(kind == NumberKind::kNumber && value == std::floor(value))) return false;
    if (field == 'c' && !(kind == NumberKind::kNumber && value >= 0.0 && value <= 1.0)) return false;
  }
  return true;
}

enum class Fit : std::uint8_t { kNone, kFirst, kAll };

/// Whether the first rows match a layout. A header is accepted only by NiTE 2's.
Fit fitOf(const Layout& layout, std::string_view text, std::string_view file) {
  if (layout.expectedRow.empty()) return Fit::kNone;
  RowReader reader(text, file);
  int rows = 0;
  bool mayBeHeader = layout.format == JointFormat::kNite2;
  while (rows < kRowsLookedAt && reader.next()) {
    if (std::exchange(mayBeHeader, false) && isWord(reader.field(0))) continue;
    if (!fits(layout, reader)) return rows == 0 ? Fit::kNone : reader.cutOff() ? Fit::kAll : Fit::kFirst;
    ++rows;
  }
  return rows > 0 ? Fit::kAll : Fit::kNone;
}

std::string listed(const std::vector<JointFormat>& formats) {
  std::string text;
  for (int i = 0; i < countOf(formats); ++i) {
    text += i == 0 ? "" : i + 1 == countOf(formats) ? " and " : ", ";
    text += nameOf(formats[i]);
  }
  return text;
}

}  // namespace

int Layout::count(bool withMore) const {
  return countOf(before) + (countOf(fields) + (withMore ? countOf(more) : 0)) * countOf(order) / rowsPerFrame;
}

JointOrder orderOf(int count) {
  if (count == countOf(kKinect1Order)) return {kKinect1Order, "Kinect v1"};
  if (count == countOf(kKinect2Order)) return {kKinect2Order, "Kinect v2"};
  if (count == countOf(kAzureOrder)) return {kAzureOrder, "Azure Kinect"};
  if (count == countOf(kMediaPipeOrder)) return {kMediaPipeOrder, "MediaPipe"};
  return {};
}

std::optional<SensorJoint> Numbering::jointOf(int number) const {
  const bool known = number >= first && number - first < countOf(order.joints);
  return known ? std::optional(order.joints[number - first]) : std::nullopt;
}

Numbering numberingOf(const std::set<int>& numbers, bool landmarks) {
  constexpr int kLandmarks = 33;
  if (numbers.empty()) return {};
  const int min = *numbers.begin(), max = *numbers.rbegin();
  if (landmarks && max < kLandmarks) return {orderOf(kLandmarks), 0};
  for (int first = std::clamp(min, 0, 1); first >= 0; --first) {
    const JointOrder order = orderOf(max + 1 - first);
    // Joints that were never seen may be absent.
    if (!order.joints.empty() && 5 * countOf(numbers) >= 4 * countOf(order.joints)) return {order, first};
  }
  return {};
}

bool isJson(std::string_view text) {
  constexpr std::string_view kBefore = " \t\r\n\xef\xbb\xbf";
  text.remove_prefix(std::min(text.find_first_not_of(kBefore), text.size()));
  if (!text.starts_with('[')) return text.starts_with('{');
  text.remove_prefix(std::min(text.find_first_not_of(kBefore, 1), text.size()));
  return text.starts_with('[') || text.starts_with('{');
}

bool isMarkerTable(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text.starts_with("PathFileType");
}

const Layout& layoutOf(JointFormat format) {
  return kLayouts[static_cast<int>(format)];
}

Result<JointFormat> detectFormat(std::string_view text, std::string_view file) {
  RowReader reader(text, file);
  if (!reader.next()) {
    return unsupported("{}: found {}, expected recorded joints", file,
                       text.find('#') == std::string_view::npos ? "an empty file" : "a text of remarks");
  }
  const auto unknown = [&] {
    return unsupported(
        "{}: found {} that begins with {}, expected recorded joints in a layout that Lorica knows, or "
        "in one that --format names",
        file, text.find('\0') == std::string_view::npos ? "a text" : "data", quotedWord(reader.field(0)));
  };
  const auto has = [&](std::string_view word) { return text.find(word) != std::string_view::npos; };
  if (isJson(text)) {
    if (has("\"joint_positions\"")) return JointFormat::kAzureJson;
    const bool frames = has("andmark") || has("eypoint") || has("isibility") || has("rame") || has("ose");
    if (!frames && reader.field(0).starts_with('{')) return unknown();
    return JointFormat::kMediaPipeJson;
  }
  if (isMarkerTable(text)) return JointFormat::kTrc;
  if (const std::optional<JointFormat> format = formatOfHeader(reader)) return *format;
  if (isBodyRow(reader)) return JointFormat::kKinect2Bodies;

  std::vector<JointFormat> fitting, beginning;
  for (const Layout& layout : kLayouts) {
    const Fit fit = fitOf(layout, text, file);
    if (fit == Fit::kAll) fitting.push_back(layout.format);
    if (fit == Fit::kFirst) beginning.push_back(layout.format);
  }
  if (fitting.size() == 1) return fitting.front();
  // The file probably has a bad row: reading it in this format reports which one.
  if (fitting.empty() && beginning.size() == 1) return beginning.front();
  if (fitting.empty()) return unknown();
  return badFormat("{}: found rows that match {}, expected a single match; specify the layout with --format", file,
                   listed(fitting));
}

}  // namespace lorica::joints

namespace lorica {

std::string_view nameOf(JointFormat format) {
  return joints::layoutOf(format).name;
}

std::optional<JointFormat> jointFormatNamed(std::string_view name) {
  for (const joints::Layout& layout : joints::kLayouts) {
    if (layout.name == name) return layout.format;
  }
  return std::nullopt;
}

}  // namespace lorica
