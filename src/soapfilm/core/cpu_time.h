// The CPU time of a run's own threads, whatever else the process does.
#pragma once

#include <pthread.h>

#include <ctime>
#include <mutex>
#include <vector>

namespace soapfilm {

/// The CPU time that a thread has taken so far; any thread may ask while it lives.
class ThreadClock {
 public:
  /// Of the calling thread.
  ThreadClock() { pthread_getcpuclockid(pthread_self(), &clock_); }

  double seconds() const {
    timespec time{};
    clock_gettime(clock_, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  bool operator==(const ThreadClock& other) const { return clock_ == other.clock_; }

 private:
  clockid_t clock_{};
};

/// The CPU time of threads that come and go, while they are there.
class CpuTime {
 public:
  /// The calling thread comes; and goes.
  void enter() {
    const ThreadClock own;
    const std::lock_guard lock(mutex_);
    there_.push_back({own, own.seconds()});
  }
  void leave() {
    const ThreadClock own;
    const std::lock_guard lock(mutex_);
    for (auto t = there_.begin(); t != there_.end(); ++t)
      if (t->clock == own) {
        gone_ += own.seconds() - t->begin;
        there_.erase(t);
        return;
      }
  }

  /// Of all so far.
  double seconds() const {
    const std::lock_guard lock(mutex_);
    double sum = gone_;
    for (const Thread& t : there_) sum += t.clock.seconds() - t.begin;
    return sum;
  }

 private:
  struct Thread {
    ThreadClock clock;
    double begin;
  };
  mutable std::mutex mutex_;
  std::vector<Thread> there_;
  double gone_ = 0;
};

}  // namespace soapfilm
