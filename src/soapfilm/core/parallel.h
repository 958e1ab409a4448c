// Loops on the threads of a context. Work is cut into chunks whose bounds depend only on `count` and `grain`, so the
// result of a chunk is the same for any number of threads and every thread library.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <type_traits>

#include "soapfilm/context.h"

namespace soapfilm {

/// A loop's body for the threads, of any type.
class ChunkLoop {
 public:
  using Call = void (*)(void* body, size_t begin, size_t end);
  static void run(const Context& context, size_t count, size_t grain, void* body, Call call);
  static void confine(const Context& context, void* body, Call call);
};

/// body(begin, end) for the chunks [k * grain, min((k + 1) * grain, count)), by one thread in order; returns when all
/// are done. An exception from the body is rethrown here; with several, the one of the lowest chunk. Throws Cancelled.
template <class Body>
void parallel_chunks(const Context& context, size_t count, size_t grain, Body&& body) {
  using Stored = std::remove_reference_t<Body>;
  ChunkLoop::run(context, count, std::max<size_t>(grain, 1),
                 const_cast<void*>(static_cast<const void*>(std::addressof(body))),
                 [](void* stored, size_t begin, size_t end) { (*static_cast<Stored*>(stored))(begin, end); });
}

/// body(i) for each i in [0, count), `grain` of them per task.
template <class Body>
void parallel_for(const Context& context, size_t count, size_t grain, Body&& body) {
  parallel_chunks(context, count, grain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) body(i);
  });
}

/// body() once, on the calling thread. For a library with its own loops on the same thread library (Embree's tree
/// builder): these use only the context's threads.
template <class Body>
void confine(const Context& context, Body&& body) {
  using Stored = std::remove_reference_t<Body>;
  ChunkLoop::confine(context, const_cast<void*>(static_cast<const void*>(std::addressof(body))),
                     [](void* stored, size_t, size_t) { (*static_cast<Stored*>(stored))(); });
}

}  // namespace soapfilm
