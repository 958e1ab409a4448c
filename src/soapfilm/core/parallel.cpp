#include "soapfilm/core/parallel.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace soapfilm {

struct Parallel::Impl {
  tbb::task_arena arena;
};

Parallel::Parallel(int threads)
    : threads_(threads > 0 ? threads : tbb::this_task_arena::max_concurrency()), impl_(std::make_unique<Impl>()) {
  impl_->arena.initialize(threads_);
}

Parallel::~Parallel() = default;

void Parallel::run(size_t count, size_t grain, void* body, ChunkFunction call) const {
  const size_t chunks = (count + grain - 1) / grain;
  if (threads_ == 1 || chunks <= 1) {
    for (size_t k = 0; k < chunks; ++k) call(body, k * grain, std::min((k + 1) * grain, count));
    return;
  }
  impl_->arena.execute([&] {
    tbb::parallel_for(size_t{0}, chunks, [&](size_t k) { call(body, k * grain, std::min((k + 1) * grain, count)); });
  });
}

void Parallel::run_confined(void* body, ChunkFunction call) const {
  impl_->arena.execute([&] { call(body, 0, 1); });
}

}  // namespace soapfilm
