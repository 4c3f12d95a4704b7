#pragma once

#include "geometry/named_file.h"
#include "skinning/import/character_file.h"

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lorica {

/// What a program lends to long work: threads, progress, an end before the end, warnings, and which files it may open.
/// One object goes down through session/prepare/ and player/; the work of one thread uses it at a time.
class Host {
 public:
  virtual ~Host() = default;

  /// A task begins: its label ("Decomposing mannequin"), and what is counted ("parts").
  virtual void beginTask(const std::string& /*label*/, const std::string& /*unit*/) {}
  /// How much is done, of a total that is 0 or less if unknown; third, the share of the task's work, if its items
  /// differ: below 0 = done of total.
  virtual void report(int /*done*/, int /*total*/, double /*share*/) {}
  virtual void endTask() {}  ///< that of the last beginTask()
  /// What is reported from now on counts from one share of the enclosing stage to another; endStage() ends it. Third,
  /// its name: "mesh 4 of 10"; empty = that of the enclosing stage.
  virtual void beginStage(double /*from*/, double /*to*/, const std::string& /*name*/) {}
  virtual void endStage() {}  ///< that of the last beginStage()
  /// Whether the work should stop with cancelled().
  [[nodiscard]] virtual bool cancelled() const { return false; }
  /// Whether this is the work of a thread in the background: what cannot be stopped there may be given up.
  [[nodiscard]] virtual bool inBackground() const { return false; }
  /// One line for the user about what happens.
  virtual void tell(const std::string& /*sentence*/) {}
  /// The same about something that may be wrong, though the work continues. Repeated sentences are told once.
  virtual void warn(const std::string& /*sentence*/) {}

  int threads = 0;                        ///< 0 = all that the machine has
  PathTrust paths = PathTrust::kBeneath;  ///< which files a file may name
  std::optional<IsolatedReader> reader;   ///< reads FBX and COLLADA in a process of its own; none = in this one

  /// How character files are read. @param hidden  see CharacterFileSettings
  [[nodiscard]] CharacterFileSettings characterFiles(std::vector<std::string> hidden = {}) const {
    CharacterFileSettings settings;
    settings.hidden = std::move(hidden);
    settings.paths = paths;
    settings.isolated = reader;
    if (settings.isolated) settings.isolated->cancelled = [this] { return cancelled(); };
    return settings;
  }
};

/// A task of a host during its lifetime.
class Task {
 public:
  /// Begins it; the destructor ends it
  Task(Host& host, const std::string& label, const std::string& unit) : host_(host) { host_.beginTask(label, unit); }
  ~Task() { host_.endTask(); }
  Task(const Task&) = delete;
  Task& operator=(const Task&) = delete;
  void update(int done, int total, double share = -1.0) { host_.report(done, total, share); }  ///< see Host::report()
  [[nodiscard]] bool cancelled() const { return host_.cancelled(); }  ///< see Host::cancelled()
  /// A progress callback that reports and stops when cancelled. The task outlives it.
  [[nodiscard]] std::function<bool(int done, int total)> progress() {
    return [this](int done, int total) {
      update(done, total);
      return !cancelled();
    };
  }

 private:
  Host& host_;
};

/// A stage of a host's work during its lifetime. The outermost one is what a user waits for.
class Stage {
 public:
  /// Begins it; the destructor ends it. @param name  see Host::beginStage()
  explicit Stage(Host& host, double from = 0.0, double to = 1.0, const std::string& name = {}) : host_(host) {
    host_.beginStage(from, to, name);
  }
  ~Stage() { host_.endStage(); }
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

 private:
  Host& host_;
};

}  // namespace lorica
