#include "geometry/errors.h"
#include "viewer/vr/headset.h"

#include <utility>

// Without the headers of OpenXR.

namespace lorica {

struct Headset::Impl {
  HeadsetFrame frame;
};

Headset::Headset(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Headset::~Headset() = default;
Headset::Headset(Headset&&) noexcept = default;
Headset& Headset::operator=(Headset&&) noexcept = default;

Result<Headset> Headset::find() {
  return noDisplay("this Lorica was built without OpenXR: install the Debian package libopenxr-dev and build it again");
}

std::string Headset::description() const {
  return {};
}
Result<void> Headset::start(Renderer::GetProc /*getProc*/) {
  return {};
}
Result<void> Headset::poll() {
  return {};
}
bool Headset::running() const {
  return false;
}
Result<void> Headset::beginFrame() {
  return {};
}
const HeadsetFrame& Headset::frame() const {
  return impl_->frame;
}
int Headset::width() const {
  return 0;
}
int Headset::height() const {
  return 0;
}
Result<void> Headset::take(int /*eye*/, Renderer& /*renderer*/) {
  return {};
}
Image Headset::picture(int /*eye*/) const {
  return {};
}
Result<void> Headset::drawPanel(const Image& /*image*/) {
  return {};
}
void Headset::placePanel(const Isometry3& /*stageFromPanel*/, double /*width*/, double /*height*/) {}
Result<void> Headset::endFrame() {
  return {};
}
void Headset::pulse(int /*hand*/, double /*strength*/) {}

}  // namespace lorica
