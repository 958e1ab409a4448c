// How many bytes the arrays of a pool take.
#pragma once

#include <atomic>
#include <cstddef>

namespace soapfilm {

/// Counted by all threads.
class ArrayBytes {
 public:
  void add(size_t bytes) {
    const size_t now = taken_.fetch_add(bytes) + bytes;
    for (size_t most = most_.load(); most < now && !most_.compare_exchange_weak(most, now);) {
    }
  }
  void remove(size_t bytes) { taken_ -= bytes; }
  /// The most at once so far, since the peak was last restarted.
  size_t peak() const { return most_; }
  void restart_peak() { most_ = taken_.load(); }

 private:
  std::atomic<size_t> taken_{0};  // by arrays that live
  std::atomic<size_t> most_{0};   // of taken_ so far
};

}  // namespace soapfilm
