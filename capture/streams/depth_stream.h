#pragma once

#include "capture/sensor/depth_lens.h"
#include "geometry/result.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// What stands before each image of a depth stream, little-endian; docs/FORMATS.md says it field by field.
inline constexpr std::size_t kDepthHeaderBytes = 136;
inline constexpr std::string_view kDepthMagic = "LORDEPTH";
/// @param time  in the sender's clock [s]; below 0: unknown, so the time of arrival counts
[[nodiscard]] std::array<std::byte, kDepthHeaderBytes> depthHeaderOf(const DepthLens& lens, double time);

/// Images without headers: 16 bits a pixel, one after the other.
struct BareDepth {
  DepthLens lens;
  bool bigEndian = false;
};
/// "gray16le,640x576,fov=75x65,unit=mm", see parseDepthLens(); or gray16be.
[[nodiscard]] Result<BareDepth> parseBareDepth(std::string_view text);

/// Cuts a stream of bytes into images. It says where the next bytes belong, so none is copied; a broken stream cannot
/// make it reserve more than one image of 2048 x 2048.
class DepthFrameParser {
 public:
  /// @param bare  images without headers; none = each has one
  explicit DepthFrameParser(std::optional<BareDepth> bare = std::nullopt);

  /// Where the next bytes are to be written; never empty.
  [[nodiscard]] std::span<std::byte> wanted();
  /// So many bytes were written there. @return whether an image is complete, or why the stream is none
  [[nodiscard]] Result<bool> got(std::size_t bytes);
  /// The sender left: what was begun is forgotten. @return whether that was a part of an image
  bool restart();
  /// Whether a part of an image, or of its header, came.
  [[nodiscard]] bool within() const { return !skipping() && filled_ > 0; }
  /// Bytes of the image and its header that came, and that it has.
  [[nodiscard]] std::pair<std::size_t, std::size_t> progress() const;

  /// Of all images; none before the first header.
  [[nodiscard]] const std::optional<DepthLens>& lens() const { return lens_; }
  /// Of the complete image: as sent, in the machine's byte order. May be swapped for another one.
  [[nodiscard]] std::vector<std::uint16_t>& image() { return image_; }
  [[nodiscard]] double time() const { return time_; }  ///< of the complete image, as sent [s]

 private:
  [[nodiscard]] bool skipping() const { return skipped_ > 0; }
  [[nodiscard]] Result<void> readHeader();
  [[nodiscard]] Result<bool> findHeader();

  std::optional<BareDepth> bare_;
  std::optional<DepthLens> lens_;
  std::array<std::byte, kDepthHeaderBytes> header_{};
  std::size_t filled_ = 0;  ///< bytes of the header, then of the image
  bool inImage_ = false;
  std::size_t skipped_ = 0;  ///< bytes since the last image that are no header
  std::vector<std::uint16_t> image_;
  double time_ = -1.0;
};

/// How a depth stream is received.
struct DepthStreamSettings {
  std::string at;                 ///< "-", a path with a / in it, [HOST:]PORT; see DepthStream
  std::optional<BareDepth> bare;  ///< none = images have headers
  double stall = 10.0;            ///< a sender that stops within an image so long is left [s]
  double silence = 2.0;           ///< a sender that says nothing so long gives way to another that comes [s]
};

/// Depth images that another program sends: through a pipe to standard input ("-"), a named pipe, a Unix socket, which
/// is made here, or TCP, where this machine alone may connect unless a host is named.
///
/// A thread of its own receives them; next() gives the newest, and the ones that it replaces are dropped and counted.
/// One sender at a time; if it leaves, kUnplugged is given until the next comes, whose camera must be the same. Times
/// start at 0 and go on over its pauses; a sender's clock that disagrees with ours by more than a second is not used.
/// Standard input has an end. What is no depth stream is an error, once and for all; once the camera is known, who
/// sends that to a socket or a port is left and counted instead. No allocation after the first image.
class DepthStream : public DepthSource {
 public:
  struct Counts {
    std::int64_t images = 0;   ///< that came whole
    std::int64_t dropped = 0;  ///< of these, replaced by newer ones before they were read
    std::int64_t broken = 0;   ///< images whose sender stopped or left in the middle
    std::int64_t senders = 0;
    std::int64_t refused = 0;  ///< of these, left because what they sent was no stream of this camera
  };

  /// Rejects an address that cannot be, before any work.
  [[nodiscard]] static Result<void> check(const DepthStreamSettings& settings);
  /// Listens, and waits for the first header, unless images have none: forever, or until the thread's work is stopped.
  /// @return the source, or why there is none: the port is taken, a file that is no pipe, a stream that is none
  [[nodiscard]] static Result<std::unique_ptr<DepthStream>> open(const DepthStreamSettings& settings);

  [[nodiscard]] virtual Counts counts() const = 0;
  /// The port that it listens on; 0 = none.
  [[nodiscard]] virtual std::uint16_t port() const = 0;
};

/// What a user is told of where a stream comes from: "standard input", "127.0.0.1:7000", a path.
[[nodiscard]] std::string depthStreamName(const std::string& at);

}  // namespace lorica
