#include "soapfilm/field/samples.h"

#include <fmt/core.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <numeric>
#include <tuple>
#include <type_traits>
#include <utility>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/some_by_place.h"
#include "soapfilm/error.h"

namespace soapfilm {

namespace {

constexpr size_t most_chunks = 16;
constexpr size_t samples_per_task = size_t{1} << 14;

/// Where the samples may be on disk, they are put into so many parts of the bricks one after the other: each part has
/// room in memory, and the cloud, read as often, is a stream.
size_t parts_at_once(size_t samples, const Context& context) {
  constexpr size_t most = 16, share = 4;  // of memory
  constexpr size_t each = 3 * sizeof(Vec3f) + 2 * sizeof(float);
  if (context.state().scratch_folder.empty()) return 1;
  const size_t room = context.memory_limit().value_or(available_memory_bytes());
  return std::clamp<size_t>(share * each * samples / std::max<size_t>(room, 1), 1, most);
}

/// A counting sort by brick, so it is stable: the order within a brick is the cloud's, for any number of chunks.
class BrickSort {
 public:
  BrickSort(const PointCloud& cloud, std::span<const Vec3f> directions, const Lattice& lattice, const Context& context,
            const std::function<bool(size_t)>& wanted)
      : cloud_(cloud), directions_(directions), lattice_(lattice), context_(context), wanted_(wanted) {
    BrickMask occupied(lattice.box(0).bricks);
    parallel_chunks(context, cloud.size(), samples_per_task, [&](size_t begin, size_t end) {
      for_each_sample(begin, end, [&](size_t, Vec3i brick, bool is_new, Vec3d) {
        if (is_new) occupied.set_shared(brick);
      });
    });
    bricks_ = BrickGrid(occupied, context);
    chunks_ = std::clamp<size_t>(cloud.size() / (2 * std::max<size_t>(bricks_.size(), 1)), 1, most_chunks);
    next_.resize(chunks_ * bricks_.size());
    for_each_place(0, bricks_.size(), [](size_t, size_t, Vec3f) {});
    uint32_t count = 0;
    for (size_t b = 0; b < bricks_.size(); ++b) {
      for (size_t c = 0; c < chunks_; ++c) count += std::exchange(next_[c * bricks_.size() + b], count);
      begin_.push_back(count);
    }
  }

  size_t count() const { return begin_.back(); }
  /// Once: put(i, place, position in its brick) for all of them.
  template <class Put>
  void place_all(Put&& put) {
    const size_t parts = parts_at_once(count(), context_);
    const auto brick_at = [&](size_t part) {
      const auto at = std::lower_bound(begin_.begin(), begin_.end() - 1, part * count() / parts);
      return part == parts ? bricks_.size() : static_cast<size_t>(at - begin_.begin());
    };
    for (size_t part = 0; part < parts; ++part) for_each_place(brick_at(part), brick_at(part + 1), put);
  }
  BrickGrid take_bricks() { return std::move(bricks_); }
  std::vector<uint32_t> take_begin() { return std::move(begin_); }

 private:
  /// visit(i, brick, is_new, position) for those of samples [begin, end) that are used. Neighbors in a scan mostly lie
  /// in the same brick: it is looked up only when it changes.
  template <class Visit>
  void for_each_sample(size_t begin, size_t end, Visit&& visit) const {
    Vec3i last{INT_MIN, INT_MIN, INT_MIN};
    for (size_t i = begin; i < end; ++i) {
      if (!takes_part(cloud_, directions_, i) || (wanted_ && !wanted_(i))) continue;
      const Vec3d position = lattice_.to_lattice(cloud_.positions[i]);
      const Vec3i brick = brick_of(Vec3i(position));  // in the box, where no coordinate is negative
      const bool is_new = !(brick == last);
      visit(i, last = brick, is_new, position);
    }
  }
  /// put(i, place, position in its brick) for those in bricks [first, last).
  template <class Put>
  void for_each_place(size_t first, size_t last, Put&& put) {
    const size_t grain = cloud_.size() / chunks_ + 1;
    parallel_for(context_, chunks_, 1, [&](size_t c) {
      uint32_t* place = nullptr;
      for_each_sample(std::min(c * grain, cloud_.size()), std::min((c + 1) * grain, cloud_.size()),
                      [&](size_t i, Vec3i brick, bool is_new, Vec3d position) {
                        if (is_new) {
                          const auto b = static_cast<size_t>(bricks_.find(brick));
                          place = b >= first && b < last ? &next_[c * bricks_.size() + b] : nullptr;
                        }
                        if (place) put(i, (*place)++, Vec3f(position - Vec3d(brick * brick_side)));
                      });
    });
  }

  const PointCloud& cloud_;
  std::span<const Vec3f> directions_;
  const Lattice& lattice_;
  const Context& context_;
  const std::function<bool(size_t)>& wanted_;
  BrickGrid bricks_;
  size_t chunks_ = 1;
  std::vector<uint32_t> next_;  ///< of each chunk and brick: first the number, then the next place
  std::vector<uint32_t> begin_{0};
};

}  // namespace

GridSamples GridSamples::select(BrickGrid grid, std::vector<uint32_t> first, std::span<const uint32_t> taken,
                                const Context& context) const {
  GridSamples chosen;
  chosen.axis_shift = axis_shift;
  chosen.bricks = std::move(grid);
  chosen.begin = std::move(first);
  for_each_column([&](auto column) {
    const auto& from = this->*column;
    auto& to = chosen.*column;
    if (from.empty()) return;
    to.resize(taken.size());
    parallel_chunks(context, taken.size(), samples_per_task, [&](size_t begin_of, size_t end_of) {
      for (size_t k = begin_of; k < end_of; ++k) to[k] = from[taken[k]];
    });
  });
  return chosen;
}

GridSamples GridSamples::in(BrickGrid grid, const Context& context) const {
  std::vector<uint32_t> first{0}, taken;
  for (size_t b = 0; b < grid.size(); ++b) {
    if (const int32_t n = bricks.find(grid.coord(b)); n >= 0)
      for (uint32_t s = begin[static_cast<size_t>(n)]; s < begin[static_cast<size_t>(n) + 1]; ++s) taken.push_back(s);
    first.push_back(static_cast<uint32_t>(taken.size()));
  }
  return select(std::move(grid), std::move(first), taken, context);
}

uint8_t sample_hash_of(Vec3d place, const Box3d& box) { return static_cast<uint8_t>(hash_of_place(place, box)); }

void GridSamples::sort_by_place(const Context& context) {
  constexpr size_t bricks_per_task = 64;
  const auto before = [&](uint32_t a, uint32_t b) {
    const auto key = [&](uint32_t s) {
      const Vec3f &p = local[s], &d = direction[s];
      return std::make_tuple(p.z, p.y, p.x, d.z, d.y, d.x, weight_of(s));
    };
    const float from = local[a].z, to = local[b].z;
    return from != to ? from < to : key(a) < key(b);
  };
  parallel_chunks(context, bricks.size(), bricks_per_task, [&](size_t first, size_t last) {
    std::vector<uint32_t> order;
    for (size_t b = first; b < last; ++b) {
      order.resize(begin[b + 1] - begin[b]);
      std::iota(order.begin(), order.end(), begin[b]);
      std::stable_sort(order.begin(), order.end(), before);
      for_each_column([&](auto column) {
        auto& values = this->*column;
        if (values.empty()) return;
        auto sorted = std::remove_cvref_t<decltype(values)>();
        sorted.reserve(order.size());
        for (const uint32_t s : order) sorted.push_back(values[s]);
        std::copy(sorted.begin(), sorted.end(), values.begin() + begin[b]);
      });
    }
  });
}

std::vector<Vec3d> lattice_positions(const GridSamples& samples) {
  std::vector<Vec3d> positions;
  positions.reserve(samples.size());
  for (size_t b = 0; b < samples.bricks.size(); ++b)
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s)
      positions.push_back(Vec3d(samples.bricks.first_vertex(b)) + Vec3d(samples.local[s]));
  return positions;
}

double weight_scale(const PointCloud& cloud) {
  constexpr float smallest = 0.1f, largest = 10;  // medians that are left as they are
  constexpr float most_above_median = 1e6f;       // sums over a level stay exact enough
  if (cloud.weights.empty()) return 1;
  std::vector<float> positive;
  positive.reserve(cloud.size());
  for (size_t i = 0; i < cloud.size(); ++i) {
    const float weight = cloud.weights[i];
    if (!(weight >= 0) || !std::isfinite(weight))
      throw SamplesError(fmt::format("sample {}: weight = {}, must be finite and >= 0", i, weight));
    if (weight > 0) positive.push_back(weight);
  }
  if (positive.empty()) throw SamplesError("the weights of all samples are 0, some must be > 0");
  const auto middle = positive.begin() + static_cast<std::ptrdiff_t>(positive.size() / 2);
  std::nth_element(positive.begin(), middle, positive.end());
  const float median = *middle;
  if (const float most = *std::max_element(middle, positive.end()); most / most_above_median > median)
    throw SamplesError(fmt::format("the largest weight = {:g}, must be at most {:g} times the median one, {:g}", most,
                                   most_above_median, median));
  return median >= smallest && median <= largest ? 1 : 1 / static_cast<double>(median);
}

GridSamples sort_samples(const PointCloud& cloud, std::span<const Vec3f> directions, const Lattice& lattice,
                         const Context& context, const std::function<bool(size_t)>& wanted) {
  GridSamples samples;
  samples.axis_shift = lattice.axis_shift;
  BrickSort sort(cloud, directions, lattice, context, wanted);
  const auto make_room = [&](auto& values) {
    reserve_many(values, sort.count());
    values.resize(sort.count());
  };
  const double scale = weight_scale(cloud);
  const Box3d cloud_box = cloud.box(context);
  make_room(samples.local);
  make_room(samples.direction);
  if (!cloud.weights.empty()) make_room(samples.weight);
  make_room(samples.source);
  make_room(samples.sample_hash);
  sort.place_all([&](size_t i, size_t k, Vec3f local) {
    samples.local[k] = local;
    samples.direction[k] = lattice.from_world_axes(directions[i]);
    if (!cloud.weights.empty()) samples.weight[k] = static_cast<float>(scale * cloud.weights[i]);
    samples.source[k] = static_cast<uint32_t>(i);
    samples.sample_hash[k] = sample_hash_of(cloud.positions[i], cloud_box);
  });
  samples.bricks = sort.take_bricks();
  samples.begin = sort.take_begin();
  samples.sort_by_place(context);
  if (!samples.weight.empty()) samples.weigh_directions(context, [&](size_t s) { return samples.weight[s]; });
  return samples;
}

}  // namespace soapfilm
