#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "soapfilm/core/progress.h"

namespace soapfilm {

/// Runs the stages of a pipeline one after the other: tells the progress object and keeps the elapsed seconds.
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

  const std::vector<std::pair<std::string, double>>& seconds() const { return seconds_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Timer {
    Stages& stages;
    const char* name;
    Clock::time_point begin = Clock::now();
    ~Timer() {
      const double elapsed = std::chrono::duration<double>(Clock::now() - begin).count();
      stages.seconds_.emplace_back(name, elapsed);
      stages.progress_.end_stage(elapsed);
    }
  };

  Progress& progress_;
  std::vector<std::pair<std::string, double>> seconds_;
};

}  // namespace soapfilm
