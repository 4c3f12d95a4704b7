#pragma once

#include "capture/sensor/depth_frame.h"
#include "geometry/result.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace lorica {

/// What a recording of depth says of itself.
struct DepthRecordingInfo {
  std::string format;     ///< "OpenNI 1.0.1.0", "16-bit PNG pictures"
  std::string device;     ///< as named by the recorder; may be empty
  std::string lens;       ///< what its camera was taken from: "its calibration"; empty = the images are a pinhole's
  int frameCount = 0;     ///< at least one
  double duration = 0.0;  ///< from the first frame to the last [s]
  bool cutOff = false;    ///< it was truncated; its complete frames are there
  std::vector<std::string> notes = {};  ///< what was repaired or left out
};

/// The depth frames of a recording, each once, in order, as fast as they are requested.
class DepthRecording : public DepthSource {
 public:
  [[nodiscard]] std::string name() const final { return name_; }
  [[nodiscard]] const DepthRecordingInfo& about() const { return about_; }  ///< read when it was opened
  [[nodiscard]] Result<DepthRead> next(DepthFrame& frame) final;

  /// Index of the frame that next() returns now; about().frameCount at the end.
  [[nodiscard]] int position() const { return position_; }
  /// Moves to a frame; costs little. @param frame  clamped to 0 .. about().frameCount
  void seek(int frame);

 protected:
  /// At its first frame.
  DepthRecording(std::string name, DepthRecordingInfo about) : name_(std::move(name)), about_(std::move(about)) {}
  /// @param frame  below about().frameCount
  /// @param out    overwritten completely, reusing its storage; undefined after an error
  [[nodiscard]] virtual Result<void> read(int frame, DepthFrame& out) = 0;

 private:
  std::string name_;
  DepthRecordingInfo about_;
  int position_ = 0;
  DepthFrame scratch_;
};

/// Whether a file or folder is a recording of depth, by its name and its beginning: .oni; .mkv (Azure Kinect, Femto);
/// .bag (RealSense, ROS 1); a folder of PNG pictures, or with depth.txt; arrays of numpy, .npy of (frames, height,
/// width) and .npz with one that is named depth.
[[nodiscard]] bool isDepthRecording(const std::filesystem::path& path);

/// Opens any of these. Images of a distorted lens are undone to a pinhole's, in millimetres.
/// @param lens  the camera, see parseDepthLens(), instead of what the recording or a .json file beside it says; empty =
///              none. Of images that nothing is said of, it is the usual camera of their size
/// @return the recording, or an error with file, place, found and expected
[[nodiscard]] Result<std::unique_ptr<DepthRecording>> openDepthRecording(const std::filesystem::path& path,
                                                                         const std::string& lens = {});

/// Where a recording ends by itself; 0 = nowhere.
struct RecordingLimits {
  int frames = 0;        ///< images
  double seconds = 0.0;  ///< from the first image on
};

/// Writes all images of a source as .oni while they come, and gives each of them in order: one that is not read in time
/// is read from the file. The source belongs to a thread of the recorder meanwhile. Its next() returns kEnd after the
/// last image, and an error, of the source or of the disk, after those that came before it. Its destructor abandons an
/// unfinished recording and keeps the x.part.oni file.
class DepthRecorder : public DepthSource {
 public:
  /// Creates a file beside `file`, named x.part.oni. It can be played even if this program is killed; if a killed
  /// program left such a file behind, it is kept as x.found-1.oni. No file is left if this fails.
  /// @param source  must outlive the recorder
  [[nodiscard]] static Result<std::unique_ptr<DepthRecorder>> start(DepthSource& source,
                                                                    const std::filesystem::path& file,
                                                                    const RecordingLimits& limits = {});

  /// No further image is recorded; those that were not read yet can still be.
  virtual void stop() = 0;

  /// The recording that a killed program left behind, under its new name; nothing if there was none.
  [[nodiscard]] virtual const std::optional<std::filesystem::path>& found() const = 0;
  /// Ends the recording and renames it to its final name. @return number of frames
  [[nodiscard]] virtual Result<int> finish() = 0;
  /// Ends the recording and removes its file, for one without frames.
  virtual void discard() = 0;
};

/// Writes a recording as .oni, without loss.
/// @param progress  gets how many frames are written; returns false to stop with kCancelled
[[nodiscard]] Result<void> writeOni(DepthRecording& recording, const std::filesystem::path& file,
                                    const std::function<bool(int)>& progress = {});

}  // namespace lorica
