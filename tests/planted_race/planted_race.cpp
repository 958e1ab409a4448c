// Races on purpose: two chunks of one loop, on two threads, write the same variable. The test passes only if
// ThreadSanitizer says so.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <thread>

#include "soapfilm/core/parallel.h"

int main() {
  const soapfilm::Context context(2);
  std::atomic<int> arrived{0};
  size_t sum = 0;
  parallel_for(context, 2, 1, [&](size_t i) {
    sum += i;
    // Hold this thread until the other chunk is on another one. Relaxed, so that the wait orders nothing.
    arrived.fetch_add(1, std::memory_order_relaxed);
    for (int ms = 0; ms < 10000 && arrived.load(std::memory_order_relaxed) < 2; ++ms)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  std::printf("sum %zu\n", sum);
}
