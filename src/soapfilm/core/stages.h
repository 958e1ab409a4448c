#pragma once

#include <chrono>
#include <ctime>
#include <string>
#include <vector>

#include "soapfilm/core/progress.h"

namespace soapfilm {

/// What a stage took, in seconds: by the clock, and of all threads of the process.
struct StageTime {
  std::string name;
  double elapsed = 0;
  double cpu = 0;
};

/// Runs the stages of a pipeline one after the other: tells the progress object and keeps the times.
class Stages {
 public:
  explicit Stages(Progress& progress) : progress_(progress) {}

  template <class Work>
  auto run(const char* name, Work&& work) {
    progress_.check();
    progress_.begin_stage(name);
    const Timer timer{*this, name};
    return work();
  }

  const std::vector<StageTime>& times() const { return times_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Timer {
    Stages& stages;
    const char* name;
    Clock::time_point begin = Clock::now();
    std::clock_t cpu_begin = std::clock();
    ~Timer() {
      const double elapsed = std::chrono::duration<double>(Clock::now() - begin).count();
      const double cpu = static_cast<double>(std::clock() - cpu_begin) / CLOCKS_PER_SEC;
      stages.times_.push_back({name, elapsed, cpu});
      stages.progress_.end_stage(elapsed);
    }
  };

  Progress& progress_;
  std::vector<StageTime> times_;
};

}  // namespace soapfilm
