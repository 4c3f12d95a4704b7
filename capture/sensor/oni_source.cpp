#include "capture/sensor/oni_source.h"

#include <algorithm>

namespace lorica {

Result<DepthRead> OniSource::next(DepthFrame& frame) {
  if (position_ >= info().frameCount) return DepthRead::kEnd;
  // A damaged frame must not be written partially to the caller's frame, so it is read into another one first.
  LORICA_TRY_DO(file_.read(position_, scratch_));
  std::swap(frame, scratch_);
  ++position_;
  return DepthRead::kFrame;
}

void OniSource::seek(int frame) {
  position_ = std::clamp(frame, 0, info().frameCount);
}

void OniSource::seekTime(double seconds) {
  const double wanted = file_.timeOf(0) + seconds;
  int first = 0;
  int last = info().frameCount;
  while (first < last) {
    const int middle = first + (last - first) / 2;
    if (file_.timeOf(middle) < wanted) {
      first = middle + 1;
    } else {
      last = middle;
    }
  }
  position_ = first;
}

Result<std::unique_ptr<OniSource>> openOni(const std::filesystem::path& file) {
  LORICA_TRY(OniFile opened, OniFile::open(file));
  return std::make_unique<OniSource>(std::move(opened), file.filename().string());
}

Result<std::unique_ptr<DepthSource>> makeOniSource(const std::filesystem::path& file) {
  LORICA_TRY(std::unique_ptr<OniSource> opened, openOni(file));
  return std::unique_ptr<DepthSource>(std::move(opened));
}

}  // namespace lorica
