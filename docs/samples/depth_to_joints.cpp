// Finds a person's joints in a depth recording and prints them as joint CSV.
//
//   depth_to_joints [recording.oni]

#include <lorica/capture/files/joint_csv.h>
#include <lorica/capture/sensor/oni_file.h>
#include <lorica/capture/tracking/tracker.h>

#include <cstdio>

namespace {

int fail(const lorica::Error& error) {
  std::fprintf(stderr, "depth_to_joints: %s\n", error.message.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  const auto recording = lorica::openOni(argc > 1 ? argv[1] : LORICA_RECORDINGS_DIR "/wave_depth.oni");
  if (!recording) return fail(recording.error());
  lorica::OniFile& source = **recording;

  // One tracker for each camera; it keeps the person's proportions and the floor.
  auto tracker = lorica::Tracker::create(source.camera());
  if (!tracker) return fail(tracker.error());

  // A live camera is read in the same way: openOpenNi() in capture/sensor/openni.h returns another DepthSource.
  lorica::DepthFrame frame;
  int frames = 0;
  int tracked = 0;
  std::fputs(lorica::jointCsvHeader().c_str(), stdout);
  while (true) {
    const lorica::Result<lorica::DepthRead> read = source.next(frame);
    if (!read) return fail(read.error());
    if (*read == lorica::DepthRead::kEnd) break;
    if (*read != lorica::DepthRead::kFrame) continue;  // a live camera may be unplugged for a while
    ++frames;
    const std::span<const lorica::TrackedPerson> people = tracker->track(frame);
    if (!people.empty()) ++tracked;
    // Joints are in the floor frame: metres, Y up, y = 0 on the floor below the camera.
    for (const lorica::TrackedPerson& person : people) {
      std::fputs(lorica::jointCsvRow(person.skeleton).c_str(), stdout);
    }
  }
  std::fprintf(stderr, "%d of %d frames show a person\n", tracked, frames);
  return tracked > 0 ? 0 : 1;
}
