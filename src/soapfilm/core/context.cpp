#include "soapfilm/core/context.h"

#include "soapfilm/core/threads.h"

namespace soapfilm {

Context::Context(int threads, SimdTarget simd)
    : reports_(&part_),
      stopped_by_(&part_),
      simd_(simd),
      threads_(std::make_shared<Threads>(threads)),
      pages_(PagePool::make()) {}

Context::Context(int threads, Progress& progress, SimdTarget simd)
    : reports_(&progress),
      stopped_by_(&progress),
      simd_(simd),
      threads_(std::make_shared<Threads>(threads)),
      pages_(PagePool::make()) {}

Context::Context(const Context& parent, Progress* whole, double begin, double end)
    : reports_(&part_),
      stopped_by_(parent.stopped_by_),
      simd_(parent.simd_),
      threads_(parent.threads_),
      pages_(parent.pages_) {
  part_.whole = whole;
  part_.begin = begin;
  part_.end = end;
}

Context::~Context() = default;

Context Context::silent() const { return Context(*this, nullptr, 0, 1); }

Context Context::part(double begin, double end) const { return Context(*this, reports_, begin, end); }

double Context::cpu_seconds() const {
  return threads_->helpers_time().seconds() + 1e-9 * static_cast<double>(thread_cpu_time());
}

int Context::threads() const { return threads_->count(); }

}  // namespace soapfilm
