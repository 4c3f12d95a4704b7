#include "viewer/window/window_impl.h"

#include "viewer/pictures/image_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace lorica {
namespace {

constexpr double kVideoRate = 30.0;  // [1/s]

/// The first unused name of lorica-001, lorica-002 ... in the working directory.
std::string freeName(const char* extension) {
  std::string name;
  for (int i = 1; i <= 999; ++i) {
    name = fmt::format("lorica-{:03}{}", i, extension);
    std::error_code error;
    if (!std::filesystem::exists(name, error)) break;
  }
  return name;
}

/// Encoders accept only even sizes.
Image croppedToEven(Image image) {
  Image even = Image::filled(image.width & ~1, image.height & ~1);
  for (int y = 0; y < even.height; ++y) std::copy_n(image.pixel(0, y), 4 * even.width, even.pixel(0, y));
  return even;
}

}  // namespace

Image readWindow(const GlFunctions& gl, int width, int height) {
  Image image = readPixels(gl, 0, width, height);
  for (std::size_t k = 3; k < image.rgba.size(); k += 4) image.rgba[k] = 255;
  return image;
}

void Window::Impl::savePicture(const Image& image) {
  const std::string name = freeName(".png");
  const Result<void> written = writePng(name, image, NamedBy::kLorica);
  setNotice(written.ok() ? "saved " + name : written.error().message);
}

void Window::Impl::toggleVideo(int width, int height) {
  if (video) return endVideo();
  const std::string name = freeName(".mp4");
  Result<VideoWriter> writer = VideoWriter::create(name, width & ~1, height & ~1, kVideoRate);
  if (!writer.ok()) return setNotice(writer.error().message);
  video.emplace(WindowVideo{std::move(writer).value(), name, width, height, now(), 0});
}

/// Adds as many frames as the elapsed time requires: late pictures are repeated.
void Window::Impl::addToVideo(int width, int height) {
  if (width != video->width || height != video->height) return endVideo();
  const int due = std::floor((now() - video->begin) * kVideoRate) + 1;
  if (video->frames >= due) return;
  const Image image = croppedToEven(renderer->readBack());
  while (video->frames < due) {
    if (Result<void> added = video->writer.add(image); !added.ok()) {
      setNotice(added.error().message);
      video.reset();
      return;
    }
    ++video->frames;
  }
}

void Window::Impl::endVideo() {
  const Result<void> written = video->writer.finish();
  setNotice(written.ok() ? "saved " + video->name : written.error().message);
  video.reset();
}

}  // namespace lorica
