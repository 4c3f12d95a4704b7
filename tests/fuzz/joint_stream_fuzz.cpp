#include "capture/files/joint_stream.h"
#include "capture/files/joint_stream_layouts.h"
#include "capture/smoothing.h"
#include "geometry/files.h"
#include "geometry/result.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

/// Any bytes as recorded joints: told by their content, and as a layout that their number of bytes picks. What is
/// accepted must be sound; one in 256, as its bytes have it, is smoothed and mirrored too, which takes far longer.
namespace {

using namespace lorica;

void expectSound(const JointStream& stream, std::string_view text) {
  LORICA_CHECK(!stream.frames.empty() && !stream.people.empty(), "accepted without a frame or a person");
  // Nothing can make many frames of few bytes: a frame takes three joints with three numbers each.
  LORICA_CHECK(stream.frames.size() <= 1 + text.size() / 20, "more frames than the file can hold");
  double last = -1e300;
  for (const SkeletonFrame& frame : stream.frames) {
    LORICA_CHECK(frame.time > last && std::abs(frame.time) <= 1e12, "times do not rise");
    last = frame.time;
    for (const TrackedJoint& joint : frame.joints) {
      LORICA_CHECK(joint.position.cwiseAbs().maxCoeff() <= 100.0, "a joint out of the world");
      LORICA_CHECK(joint.confidence >= 0.0 && joint.confidence <= 1.0, "no confidence");
      LORICA_CHECK(!joint.orientation || std::abs(joint.orientation->norm() - 1.0) < 0.01, "no unit quaternion");
    }
  }
  if (contentHash(text) % 256 != 0) return;
  OneEuroFilter filter;
  for (SkeletonFrame frame : stream.frames) {
    filter.apply(frame);
    mirror(frame);
    for (const TrackedJoint& joint : frame.joints) LORICA_CHECK(joint.position.allFinite(), "smoothed to nowhere");
  }
  LORICA_CHECK(filter.delay() >= 0.0 && filter.delay() <= 0.6, "no delay");
}

void expectSentence(const Error& error) {
  LORICA_CHECK(error.message.find("found") != std::string::npos, "an error that does not say what was found");
  LORICA_CHECK(error.message.find("expected") != std::string::npos, "an error that does not say what was expected");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto picked = static_cast<JointFormat>(size % kJointFormatCount);
  for (const JointStreamSettings& settings : {JointStreamSettings{}, JointStreamSettings{picked}}) {
    const Result<JointStream> stream = parseJointStream(text, "fuzz", settings);
    if (stream) {
      expectSound(*stream, text);
    } else {
      expectSentence(stream.error());
    }
  }
  // Two files, divided by a 0.
  const std::size_t middle = text.find('\0');
  if (middle == std::string_view::npos) return 0;
  Result<joints::RawStream> raw = joints::readUiPrmd(text.substr(0, middle), "p", text.substr(middle + 1), "a");
  if (!raw) {
    expectSentence(raw.error());
    return 0;
  }
  const Result<JointStream> stream = joints::finish(std::move(*raw), JointFormat::kUiPrmd, "p", {});
  if (stream) expectSound(*stream, text);
  return 0;
}
