// The copy that kernels are measured beside: it reads and writes each line of the cache by plain vector stores.
//
// memcpy and memmove, which compilers make of a copying loop, go past the cache from some size on, or take the
// processor's own string copy. Neither reads the lines that it is about to write, as the stores of every kernel do, so
// neither tells what a kernel could reach. (GCC is told so; another compiler may make a memcpy of it.)
#pragma once

#include <cstddef>

namespace soapfilm {

#if defined(__GNUC__) && !defined(__clang__)
[[gnu::optimize("no-tree-loop-distribute-patterns")]]  // no memcpy
#if defined(__x86_64__)
[[gnu::target_clones("avx512f", "avx2", "default")]]
#endif
#endif
static void
plain_copy(const float* __restrict from, float* __restrict to, size_t count) {
  for (size_t k = 0; k < count; ++k) to[k] = from[k];
}

}  // namespace soapfilm
