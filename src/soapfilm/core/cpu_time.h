// The CPU time of a run's own threads, independent of the rest of the process.
#pragma once

#include <atomic>
#include <cstdint>

#include "soapfilm/platform/memory.h"

namespace soapfilm {

/// The sum of the time that helping threads spend on a run's work.
class HelpersTime {
 public:
  double seconds() const { return 1e-9 * static_cast<double>(nanoseconds_); }

  /// Counts the calling thread's time from here to the end of the object; not inside another one on the same thread,
  /// which already counts it. Null: the time of this thread is counted elsewhere.
  class Share {
   public:
    explicit Share(HelpersTime* time) : time_(depth()++ == 0 ? time : nullptr), begin_(time_ ? thread_cpu_time() : 0) {}
    ~Share() {
      --depth();
      if (time_) time_->nanoseconds_ += thread_cpu_time() - begin_;
    }
    Share(const Share&) = delete;
    Share& operator=(const Share&) = delete;

   private:
    static int& depth() {
      static thread_local int shares = 0;
      return shares;
    }
    HelpersTime* time_;
    int64_t begin_;
  };

 private:
  std::atomic<int64_t> nanoseconds_{0};
};

}  // namespace soapfilm
