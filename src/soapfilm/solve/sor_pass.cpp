#include "soapfilm/solve/sor_pass.h"

#include <algorithm>
#include <cmath>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/kernels/kernels.h"

namespace soapfilm {

namespace {

/// Layers that a stage processes per step. The lexicographic kernel needs that many rows at once; for the many stages
/// of red-black fewer keep the ring short.
int slab_of(SorOrder order) { return order == SorOrder::lexicographic ? sor_rows : 4; }

/// visit(begin, end) for the contiguous active (or inactive) runs, in values.
template <class Visit>
void for_each_stretch(const std::vector<uint8_t>& active, uint8_t wanted, int size, Visit&& visit) {
  const int runs = static_cast<int>(active.size());
  for (int r = 0; r < runs; ++r) {
    if (active[static_cast<size_t>(r)] != wanted) continue;
    const int begin = r;
    while (r < runs && active[static_cast<size_t>(r)] == wanted) ++r;
    visit(begin * sor_run, std::min(r * sor_run, size));
  }
}

/// Room for a run before and after a row of values: kernels read whole runs, and pieces of data may extend beyond the
/// row.
constexpr size_t row_begin = sor_run;
size_t padded(int size) { return static_cast<size_t>(size) + 2 * row_begin; }

}  // namespace

SorPass::SorPass(DenseField<float>& u, double lambda, const SupportField& support, const SorParams& params,
                 const Context& context)
    : u_(u),
      params_(params),
      context_(context),
      lambda_(lambda),
      kernel_(kernels_of(context).sor),
      kinds_(u, params.skip_empty, context),
      data_(u, support, 2 / lambda),
      zeros_(padded(u.size().x), 0.0f),
      slab_(slab_of(params.order)) {
  const auto snap = static_cast<float>(params.snap), epsilon = static_cast<float>(params.epsilon);
  job_ = {.size = u.size().x,
          .row = static_cast<ptrdiff_t>(u.stride(1)),
          .layer = static_cast<ptrdiff_t>(u.stride(2)),
          .omega = static_cast<float>(params.omega),
          .low = snap,
          .high = 1.0f - snap};
  flat_g_ = 1.0f / std::sqrt(epsilon * epsilon);  // as the kernel rounds it
  // From the lowest layer that the last stage reads to the highest one that the first stage writes.
  const int stage_count = static_cast<int>(stages(params.renew_every).size());
  ring_ = std::min(u.size().z, (slab_ + 1) * stage_count + 1);
  g_ = AlignedArray<float>(static_cast<size_t>(ring_) * u.stride(2), pages_of(context));
}

std::vector<SorPass::Stage> SorPass::stages(int iterations) const {
  using enum Stage::Kind;
  std::vector<Stage> list = {{renew, 0, 0}};
  for (int k = 0; k < iterations; ++k) {
    if (params_.order == SorOrder::lexicographic) {
      list.push_back({relax, k, 0});
    } else {
      // A vertex's gradient reads neighbors of the other color: E must be computed before either color changes.
      if (k > 0) list.push_back({measure, k, 0});
      list.push_back({relax_color, k, 0});
      list.push_back({relax_color, k, 1});
    }
  }
  return list;
}

float* SorPass::g_row(int y, int z) {
  return g_.data() + static_cast<size_t>(z % ring_) * u_.stride(2) + static_cast<size_t>(y) * u_.stride(1);
}

void SorPass::clear_sums(int iterations) {
  variation_.assign(static_cast<size_t>(iterations) * static_cast<size_t>(u_.size().z), 0.0);
  product_ = variation_;
}

double SorPass::sum_energy(int iteration) const {
  const auto layers = static_cast<size_t>(u_.size().z), first = static_cast<size_t>(iteration) * layers;
  double variation = 0, product = 0;
  for (size_t i = first; i < first + layers; ++i) {
    variation += variation_[i];
    product += product_[i];
  }
  return lambda_ * (variation - product / 2);  // the data rows hold 2 f / lambda
}

double SorPass::energy() {
  clear_sums(1);
  parallel_for(context_, static_cast<size_t>(u_.size().z), 1,
               [&](size_t z) { measure_layer(static_cast<int>(z), 0, false); });
  return sum_energy(0);
}

void SorPass::run(int iterations, std::vector<double>& energy) {
  const std::vector<Stage> list = stages(iterations);
  const int layers = u_.size().z, last_stage = static_cast<int>(list.size()) - 1;
  clear_sums(iterations);
  const int steps = (layers + last_stage + slab_ - 1) / slab_ + last_stage;
  // Layers of one color stage do not read each other's values, but their kinds of runs: every second layer waits.
  std::vector<Task> tasks, waiting;
  for (int t = 0; t < steps; ++t) {
    context_.check();
    tasks.clear();
    waiting.clear();
    for (int s = last_stage; s >= 0; --s) {
      const Stage& stage = list[static_cast<size_t>(s)];
      const int first = slab_ * (t - s) - s;
      const int begin = std::max(first, 0), end = std::min(first + slab_, layers);
      const int grain = stage.kind == Stage::Kind::relax ? slab_ : 1;
      for (int z = begin; z < end; z += grain)
        (stage.kind == Stage::Kind::relax_color && z % 2 == 1 ? waiting : tasks)
            .push_back({&stage, z, std::min(z + grain, end)});
    }
    for (const std::vector<Task>* ready : {&tasks, &waiting})
      parallel_for(context_, ready->size(), 1, [&](size_t k) {
        const Task& task = (*ready)[k];
        run_task(*task.stage, task.begin, task.end);
      });
  }
  for (int k = 0; k < iterations; ++k) energy.push_back(sum_energy(k));
}

void SorPass::run_task(const Stage& stage, int begin, int end) {
  switch (stage.kind) {
    case Stage::Kind::renew:
      return measure_layer(begin, stage.iteration, true);
    case Stage::Kind::measure:
      return measure_layer(begin, stage.iteration, false);
    case Stage::Kind::relax:
      return relax_slab(begin, end, stage.iteration);
    case Stage::Kind::relax_color:
      return relax_color_layer(begin, stage.parity);
  }
}

void SorPass::measure_layer(int z, int iteration, bool renew) {
  std::vector<uint8_t> active(static_cast<size_t>(kinds_.runs()));
  for (int y = 0; y < u_.size().y; ++y) measure_row(y, z, iteration, renew, active);
}

SlopeJob SorPass::slope_job(int y, int z) {
  const auto row_at = [&](int j, int k) -> const float* {
    const bool within = j >= 0 && j < u_.size().y && k >= 0 && k < u_.size().z;
    return within ? u_.row(j, k) : zeros_.data() + row_begin;
  };
  SlopeJob job{};
  job.u = u_.row(y, z);
  job.front = row_at(y + 1, z);
  job.above = row_at(y, z + 1);
  const bool central = params_.gradient == SorGradient::central;
  job.back = central ? row_at(y - 1, z) : job.u;
  job.below = central ? row_at(y, z - 1) : job.u;
  job.left = central ? -1 : 0;
  job.per_step = central ? 0.5f : 1.0f;
  const auto epsilon = static_cast<float>(params_.epsilon);
  job.epsilon_squared = epsilon * epsilon;
  return job;
}

void SorPass::measure_row(int y, int z, int iteration, bool renew, std::vector<uint8_t>& active) {
  std::fill(active.begin(), active.end(), uint8_t{0});
  kinds_.mark(y, z, active.data());
  double variation[slope_sums] = {};
  SlopeJob job = slope_job(y, z);
  job.g = renew ? g_row(y, z) : nullptr;
  job.variation = variation;
  // The values before a row's first one and after its last one are the ends of neighboring rows, which are 0 as needed.
  for_each_stretch(active, 1, u_.size().x, [&](int begin, int end) { kernel_.slope(job, begin, end); });
  if (renew)
    for_each_stretch(active, 0, u_.size().x,
                     [&](int begin, int end) { std::fill(job.g + begin, job.g + end, flat_g_); });
  const size_t sum = static_cast<size_t>(iteration) * static_cast<size_t>(u_.size().z) + static_cast<size_t>(z);
  for (int half = slope_sums / 2; half > 0; half /= 2)
    for (int i = 0; i < half; ++i) variation[i] += variation[i + half];
  variation_[sum] += variation[0];
  product_[sum] += data_.product(y, z, job.u);
}

SorRow SorPass::relaxed_row(int y, int z, float* f, uint8_t* active) {
  const bool data = data_.spread(y, z, f, active);
  kinds_.mark(y, z, active);
  return {u_.row(y, z),    kinds_.row(y, z), g_row(y, z),
          g_row(y, z - 1), g_row(y, z + 1),  data ? f : zeros_.data() + row_begin};
}

void SorPass::relax_slab(int begin, int end, int iteration) {
  const Vec3i size = u_.size();
  const size_t pitch = padded(size.x);
  std::vector<float> f(pitch * sor_rows);
  std::vector<uint8_t> active(static_cast<size_t>(kinds_.runs()));
  SorRow rows[sor_rows];
  // Row (y, z) needs the new values of (y - 1, z) and (y, z - 1) and the old ones of (y + 1, z) and (y, z + 1): rows
  // with the same y + z do not depend on one another.
  for (int diagonal = 0; diagonal < size.y - 1 + end - begin; ++diagonal) {
    const int z_lo = std::max(begin, begin + diagonal - (size.y - 2)), z_hi = std::min(end - 1, begin + diagonal);
    // The renewal has already measured the start of the first iteration. A row's gradient only reads rows above, not
    // yet relaxed.
    if (iteration > 0)
      for (int z = z_lo; z <= z_hi; ++z) measure_row(begin + diagonal - z, z, iteration, false, active);
    std::fill(active.begin(), active.end(), uint8_t{0});
    int count = 0;
    for (int z = std::max(z_lo, 1); z <= std::min(z_hi, size.z - 2); ++z) {
      const int y = begin + diagonal - z;
      if (y < 1) continue;
      rows[count] = relaxed_row(y, z, f.data() + static_cast<size_t>(count) * pitch + row_begin, active.data());
      ++count;
    }
    if (count > 0) kernel_.relax(job_, rows, count, active.data());
  }
}

void SorPass::relax_color_layer(int z, int parity) {
  const Vec3i size = u_.size();
  if (z < 1 || z > size.z - 2) return;
  std::vector<float> f(padded(size.x));
  std::vector<uint8_t> active(static_cast<size_t>(kinds_.runs()));
  for (int y = 1; y < size.y - 1; ++y) {
    std::fill(active.begin(), active.end(), uint8_t{0});
    const SorRow row = relaxed_row(y, z, f.data() + row_begin, active.data());
    kernel_.relax_color(job_, row, (parity + y + z) & 1, active.data());
  }
}

}  // namespace soapfilm
