#include "capture/tracking/track_log.h"

#include "geometry/errors.h"
#include "geometry/new_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <iterator>
#include <system_error>

namespace lorica {
namespace {

namespace fs = std::filesystem;

Error cannotWrite(const fs::path& file) {
  return unwritable(file.string() + ": cannot be written");
}

std::string header() {
  std::string text = "frame,user";
  for (int j = 0; j < kBodyJointCount; ++j) {
    text += fmt::format(",{0}_x,{0}_y,{0}_z,{0}_confidence", nameOf(static_cast<BodyJoint>(j)));
  }
  return text + "\n";
}

}  // namespace

Result<TrackLog> TrackLog::create(const fs::path& base) {
  TrackLog log;
  for (std::size_t i = 0; i < log.parts_.size(); ++i) {
    Part& part = log.parts_[i];
    part.target = base.string() + (i == 0 ? ".cam.csv" : ".lab");
    part.path = part.target.string() + ".part";
    LORICA_TRY_DO(keepFound(part.path));
    LORICA_TRY(const int created, createPart(part.path));
    ::close(created);
    part.stream.open(part.path, std::ios::binary | std::ios::app);
    if (!part.stream) return cannotWrite(part.target);
  }
  log.parts_[0].stream << header();
  return log;
}

TrackLog::~TrackLog() {
  std::error_code ignored;
  for (Part& part : parts_) {
    if (part.path.empty()) continue;
    part.stream.close();
    fs::remove(part.path, ignored);
  }
}

void TrackLog::add(int frame, std::span<const TrackedPerson> people, Tracker& tracker) {
  const Isometry3 cameraFromFloor = tracker.floorFromCamera().inverse();
  std::string rows;
  auto out = std::back_inserter(rows);
  if (people.empty()) fmt::format_to(out, "{},0\n", frame);
  for (const TrackedPerson& person : people) {
    fmt::format_to(out, "{},{}", frame, person.skeleton.user);
    for (const TrackedJoint& joint : person.skeleton.joints) {
      const Vec3 p = cameraFromFloor * joint.position;
      fmt::format_to(out, ",{:.4f},{:.4f},{:.4f},{:.3f}", p.x(), p.y(), p.z(), joint.confidence);
    }
    rows += '\n';
  }
  parts_[0].stream << rows;
  const std::span<const std::uint8_t> labels = tracker.labels();
  parts_[1].stream.write(reinterpret_cast<const char*>(labels.data()), labels.size());
}

Result<void> TrackLog::finish() {
  for (Part& part : parts_) {
    part.stream.flush();
    if (!part.stream) return cannotWrite(part.target);
  }
  for (Part& part : parts_) {
    part.stream.close();
    std::error_code error;
    fs::rename(part.path, part.target, error);
    if (error) return cannotWrite(part.target);
    part.path.clear();
  }
  return {};
}

}  // namespace lorica
