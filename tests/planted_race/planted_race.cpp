// Races on purpose: chunks of one loop write the same variable. The test passes only if ThreadSanitizer says so.
#include <cstdio>

#include "soapfilm/core/parallel.h"

int main() {
  const soapfilm::Parallel parallel(4);
  size_t sum = 0;
  parallel.for_each(100000, 100, [&](size_t i) { sum += i; });
  std::printf("sum %zu\n", sum);
}
