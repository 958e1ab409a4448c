#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/report.h"

namespace soapfilm {

/// Runs the stages of a pipeline one after the other: reports them to the progress object and records their times.
class Stages {
 public:
  explicit Stages(const Context& context) : context_(context) {}

  template <class Work>
  auto run(const char* name, Work&& work) {
    context_.check();
    context_.progress().begin_stage(name);
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
    double cpu_begin = stages.context_.cpu_seconds();
    ~Timer() {
      const double elapsed = std::chrono::duration<double>(Clock::now() - begin).count();
      const double cpu = stages.context_.cpu_seconds() - cpu_begin;
      try {  // a destructor must not throw: what cannot be told is not told
        stages.times_.push_back({name, elapsed, cpu});
        stages.context_.progress().end_stage(elapsed);
      } catch (...) {
      }
    }
  };

  const Context& context_;
  std::vector<StageTime> times_;
};

}  // namespace soapfilm
