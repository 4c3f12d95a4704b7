#pragma once

#include "geometry/result.h"
#include "session/prepare/cast.h"
#include "viewer/player/monitored_host.h"
#include "viewer/renderer/window_values.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lorica {

/// Why nothing else can be opened.
inline constexpr const char* kWrittenOnce = "what is written or sent is one session: nothing else can be opened";

/// In the folder that recordInto() names: the files that people sent who watch.
inline constexpr const char* kSentFolder = "opened";

/// A new name of today in a folder, such as 2026-03-01_002.lsession; at most 999 of a kind a day. What others
/// ask for never fills the disk: less than 2 GiB free is an error.
/// @param ending  with its dot
[[nodiscard]] Result<std::string> newDatedFile(const std::filesystem::path& folder, std::string_view ending);

/// Opens in a window what the user drops on it or picks, while the present session continues.
class WindowOpener {
 public:
  /// @param whyNot  nothing can be opened; empty = it can
  WindowOpener(const Cast& present, Host& host, std::string whyNot);
  /// Prepares the first of several requests that can be prepared.
  using Loader = std::function<Result<Cast>(const std::vector<CastRequest>&, Host&)>;
  /// @param present  what the first files are combined with
  WindowOpener(CastRequest present, Host& host, std::string whyNot = {}, Loader load = prepareSettledCast);
  /// What loads is given up, and so it is by cancel() and by the next files.
  ~WindowOpener();

  /// What became of several files of one kind.
  struct Others {
    std::vector<std::string> files;  ///< that are not opened
    std::string remark;              ///< about them; empty if there are none
  };
  /// Starts to load the present cast with files in it, of several of one kind with the first; names without extension
  /// are of what ships. What was loading is cancelled.
  /// @return the others, or why these files cannot be opened together
  [[nodiscard]] Result<Others> open(const std::vector<std::string>& files);
  /// The same with a file of kSentFolder that somebody who watches sent now: it is removed if it cannot be opened. None
  /// of there is one of opened().
  [[nodiscard]] Result<void> openReceived(const std::string& file);
  /// The scene of the present cast was exchanged.
  void choseScene(const std::string& scene) { present_.scene = scene; }
  /// Starts to load the present cast with another clip or person of its motion's file.
  /// @param index  in the list of clips or people; -1 = everyone
  [[nodiscard]] Result<void> openClip(int index);
  [[nodiscard]] Result<void> openPerson(int index);
  /// Where record() may write: a folder that the owner of this machine chose.
  void recordInto(const std::string& folder);
  /// Why it cannot; empty = it can. With static storage duration.
  [[nodiscard]] std::string_view noRecord() const;
  /// Starts to load the present cast once more, to be recorded from its start under a new name in that folder.
  [[nodiscard]] Result<void> record();
  /// The file that what take() gave is to be recorded to; empty = none.
  [[nodiscard]] std::string takeRecord() { return std::exchange(recordTo_, ""); }
  void cancel();

  [[nodiscard]] bool loading() const { return loading_ != nullptr; }
  /// What may be dropped; empty once something was.
  [[nodiscard]] std::string_view hint() const;
  /// The files that were opened since the start or could have been, see Others; the last one last.
  [[nodiscard]] const std::vector<std::string>& opened() const { return opened_; }
  /// The files that were opened, now and in earlier runs, the last one first: the lists that listControls() gives.
  /// Those that people sent are behind them.
  void list(const std::vector<std::string>& recent);
  /// What can be opened.
  void listControls(Controls& controls) const;
  /// What is loaded and how far it is, for the window.
  void describe(WindowValues& values);
  /// The result, once; none while it loads.
  [[nodiscard]] std::optional<Result<Cast>> take();

 private:
  void remember(const Cast& loaded);
  void giveUp();
  [[nodiscard]] bool isSent(const std::filesystem::path& file) const {
    return !sent_.empty() && file.parent_path() == sent_;
  }
  void load(std::vector<CastRequest> attempts, std::vector<std::string> files);

  CastRequest present_;
  CastRequest wanted_;  // what loads, with all its options
  CastChoices choices_;
  Host& host_;
  std::string whyNot_;
  Loader load_ = prepareSettledCast;
  std::unique_ptr<BackgroundWork<Cast>> loading_;
  MonitoredHost::Progress progress_;              // for the window
  std::vector<std::string> motions_;              // that ship
  std::vector<std::string> characters_, recent_;  // to be opened again
  std::size_t sentRecent_ = 0;                    // of recent_, at its end: what people sent
  int character_ = -1;                            // the present one of characters_
  std::vector<std::string> asked_;                // files that are loading
  std::string arriving_;                          // the one of them that somebody sent; empty = none
  std::vector<std::string> opened_;
  std::string recordings_, recordTo_;
  std::filesystem::path sent_;  // the folder of what people sent; empty = nothing of it may be opened
  bool dropped_ = false;        // something was
  bool cancelled_ = false;      // what was loading, since the last take()
};

}  // namespace lorica
