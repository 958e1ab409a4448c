#include "work.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

namespace soapfilm::python {

namespace py = pybind11;

namespace {

struct Event {
  const char* kind;
  double number;
  std::string text;
};

/// Keeps the library's events until the thread that has Python takes them. Of a stage's progress only the latest.
class Mailbox : public Progress {
 public:
  void begin_stage(std::string_view name) override { put({"stage", 0, std::string(name)}); }
  void advance(double fraction, std::string_view detail) override {
    const std::lock_guard lock(mutex_);
    latest_ = Event{"advance", fraction, std::string(detail)};
  }
  void end_stage(double seconds) override { put({"done", seconds, {}}); }
  void info(const std::string& line) override { put({"info", 0, line}); }
  void detail(const std::string& line) override { put({"detail", 0, line}); }
  void warn(const std::string& line) override { put({"warning", 0, line}); }

  void finish() {
    {
      const std::lock_guard lock(mutex_);
      finished_ = true;
    }
    changed_.notify_one();
  }

  /// Waits for the end of the work, at most for `most`. Returns whether it has ended, and the events until now.
  bool take(std::chrono::milliseconds most, std::vector<Event>& events) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, most, [&] { return finished_; });
    events.swap(events_);
    if (latest_) events.push_back(*std::exchange(latest_, std::nullopt));
    return finished_;
  }

 private:
  void put(Event event) {
    const std::lock_guard lock(mutex_);
    latest_.reset();  // of a stage that is over, or older than what comes now
    events_.push_back(std::move(event));
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Event> events_;
  std::optional<Event> latest_;
  bool finished_ = false;
};

/// Runs signal handlers and callbacks; with the interpreter's lock.
void tell(const std::vector<Event>& events, const py::object& on_event) {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  if (on_event.is_none()) return;
  for (const Event& event : events) on_event(event.kind, event.number, event.text);
}

}  // namespace

void work_beside_python(int threads, const py::object& on_event, const std::function<void(const Context&)>& work,
                        std::optional<size_t> memory) {
  constexpr std::chrono::milliseconds between_looks{20};
  Mailbox mailbox;
  Context context(threads, mailbox);
  context.limit_memory(memory);
  std::exception_ptr failure, interruption;
  std::jthread worker([&] {
    try {
      work(context);
    } catch (...) {
      failure = std::current_exception();
    }
    mailbox.finish();
  });
  for (bool finished = false; !finished;) {
    std::vector<Event> events;
    {
      const py::gil_scoped_release unlocked;
      finished = mailbox.take(between_looks, events);
    }
    if (interruption) continue;
    try {
      tell(events, on_event);
    } catch (...) {
      interruption = std::current_exception();
      mailbox.cancel();
    }
  }
  worker.join();
  if (interruption) std::rethrow_exception(interruption);
  if (failure) std::rethrow_exception(failure);
}

}  // namespace soapfilm::python
