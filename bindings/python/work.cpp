#include "bindings/python/work.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

namespace lorica {
namespace {

namespace py = pybind11;

constexpr std::chrono::milliseconds kLook{50};  // how often signals are looked for

/// What the two threads tell each other.
struct Talk {
  std::mutex mutex;
  std::condition_variable changed;
  std::optional<std::pair<int, int>> question;  ///< progress that the work waits to have reported
  bool cancelled = false;
  bool done = false;
  std::exception_ptr failure;

  /// Called by the work. @return false to cancel
  bool report(int partsDone, int partsWanted) {
    std::unique_lock lock(mutex);
    if (cancelled) return false;
    question = {partsDone, partsWanted};
    changed.notify_all();
    changed.wait(lock, [&] { return !question.has_value(); });
    return !cancelled;
  }
};

/// Waits for a question, for the end, or for the next look at signals. @return the question
std::optional<std::pair<int, int>> waitFor(Talk& talk) {
  const py::gil_scoped_release released;
  std::unique_lock lock(talk.mutex);
  talk.changed.wait_for(lock, kLook, [&] { return talk.question.has_value() || talk.done; });
  return talk.question;
}

bool isDone(Talk& talk) {
  const std::lock_guard lock(talk.mutex);
  return talk.done;
}

void answer(Talk& talk, bool goOn) {
  const std::lock_guard lock(talk.mutex);
  talk.question.reset();
  if (!goOn) talk.cancelled = true;
  talk.changed.notify_all();
}

}  // namespace

py::str textFrom(std::string_view bytes) {
  PyObject* text = PyUnicode_DecodeFSDefaultAndSize(bytes.data(), static_cast<py::ssize_t>(bytes.size()));
  if (text == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(text);
}

void raise(const Error& error) {
  const bool file = error.code == ErrorCode::kUnreadable || error.code == ErrorCode::kUnwritable;
  py::object type = py::reinterpret_borrow<py::object>(file ? PyExc_OSError : PyExc_ValueError);
  if (error.code == ErrorCode::kNotFound) type = py::reinterpret_borrow<py::object>(PyExc_FileNotFoundError);
  if (error.code == ErrorCode::kCancelled) type = py::module_::import("lorica._lorica").attr("Cancelled");
  PyErr_SetObject(type.ptr(), textFrom(error.message).ptr());
  throw py::error_already_set();
}

void runAside(const py::object& progress, const std::function<void(const DecomposeProgress&)>& work) {
  if (!progress.is_none() && PyCallable_Check(progress.ptr()) == 0) {
    throw py::value_error("progress: expected a function of two numbers, or None");
  }
  Talk talk;
  std::thread worker([&] {
    std::exception_ptr failure;
    try {
      // Asked even without a function, so that Ctrl-C is seen.
      work([&](int partsDone, int partsWanted) { return talk.report(partsDone, partsWanted); });
    } catch (...) {
      failure = std::current_exception();
    }
    const std::lock_guard lock(talk.mutex);
    talk.failure = failure;
    talk.done = true;
    talk.changed.notify_all();
  });

  std::exception_ptr raised;
  while (!isDone(talk)) {
    const std::optional<std::pair<int, int>> question = waitFor(talk);
    bool goOn = !raised;
    try {
      if (goOn && PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (goOn && question && !progress.is_none()) {
        const py::object said = progress(question->first, question->second);
        goOn = !said.is(py::bool_(false));
      }
    } catch (...) {
      raised = std::current_exception();
      goOn = false;
    }
    if (question || !goOn) answer(talk, goOn);
  }
  worker.join();
  if (raised) std::rethrow_exception(raised);
  if (talk.failure) std::rethrow_exception(talk.failure);
}

void warnOf(const std::string& sentence) {
  if (sentence.empty()) return;
  if (PyErr_WarnEx(PyExc_RuntimeWarning, sentence.c_str(), 1) != 0) throw py::error_already_set();
}

void save(const DecompositionFile& content, const std::filesystem::path& file) {
  Result<void> written;
  {
    const py::gil_scoped_release released;
    written = writeDecomposition(file, content);
  }
  if (!written) raise(written.error());
}

}  // namespace lorica
