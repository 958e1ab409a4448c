#include "soapfilm/core/context.h"

#include "soapfilm/core/threads.h"

namespace soapfilm {

Context::Context(int threads, SimdTarget simd)
    : reports_(&nobody_),
      stopped_by_(&nobody_),
      simd_(simd),
      threads_(std::make_shared<Threads>(threads)),
      pages_(PagePool::make()) {}

Context::Context(int threads, Progress& progress, SimdTarget simd)
    : reports_(&progress),
      stopped_by_(&progress),
      simd_(simd),
      threads_(std::make_shared<Threads>(threads)),
      pages_(PagePool::make()) {}

Context::Context(const Context* loud)
    : reports_(&nobody_),
      stopped_by_(loud->stopped_by_),
      simd_(loud->simd_),
      threads_(loud->threads_),
      pages_(loud->pages_) {}

Context::~Context() = default;

Context Context::silent() const { return Context(this); }

double Context::cpu_seconds() const {
  return threads_->helpers_time().seconds() + 1e-9 * static_cast<double>(thread_cpu_time());
}

int Context::threads() const { return threads_->count(); }

}  // namespace soapfilm
