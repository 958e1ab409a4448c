#include "soapfilm/extract/leftover.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "soapfilm/refine/robust.h"
#include "soapfilm/refine/robust_fit.h"

namespace soapfilm {

namespace {

constexpr double radius = 1;   // voxels; the search looks at the 27 cells around
constexpr double prior = 0.1;  // samples of distance 0 in every mean
constexpr int passes = 4;
constexpr size_t most_per_cell = 16;  // samples that are listened to: more tell the same, at quadratic cost

int cell_of(Vec3f local) {
  const auto part = [](float q) { return std::min(static_cast<int>(q), brick_side - 1); };
  return brick_offset(part(local.x), part(local.y), part(local.z));
}

/// Moves `most_per_cell` of the entries of each cell, evenly chosen, to the front; returns how many these are.
template <class Entry>
size_t thin(std::span<Entry> entries) {
  size_t kept = 0;
  for (size_t first = 0; first < entries.size();) {
    size_t count = 1;
    while (first + count < entries.size() && entries[first + count].cell == entries[first].cell) ++count;
    const size_t few = std::min(count, most_per_cell);
    for (size_t k = 0; k < few; ++k) entries[kept++] = entries[first + k * count / few];
    first += count;
  }
  return kept;
}

}  // namespace

Leftover::Leftover(const GridSamples& samples, const SmoothField& field, double scale, const Parallel& parallel)
    : bricks_(samples.bricks), begin_(samples.bricks.size() + 1), entries_(samples.size()) {
  parallel.for_each(samples.bricks.size(), 32, [&](size_t b) {
    const Vec3d origin(samples.bricks.first_vertex(b));
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
      Entry& entry = entries_[s];
      entry.local = samples.local[s];
      entry.cell = static_cast<uint16_t>(cell_of(entry.local));
      const auto jet = field.at(origin + Vec3d(entry.local));
      if (!jet) continue;
      const Vec3f gradient(jet->gradient);
      const double slope = std::max(norm(jet->gradient), 0.3);
      if (!seen_from_outside(samples.direction[s], gradient)) continue;
      entry.normal = normalized(gradient);
      entry.distance = static_cast<float>(jet->value / slope);
      entry.weight = robust_weight(Penalty::tukey, entry.distance, static_cast<float>(scale));
    }
    const std::span<Entry> own(entries_.data() + samples.begin[b], samples.begin[b + 1] - samples.begin[b]);
    std::stable_sort(own.begin(), own.end(), [](const Entry& a, const Entry& c) { return a.cell < c.cell; });
    begin_[b + 1] = static_cast<uint32_t>(thin(own));
  });
  for (size_t b = 0; b < bricks_.size(); ++b) {
    const auto from = entries_.begin() + samples.begin[b];
    std::copy(from, from + begin_[b + 1], entries_.begin() + begin_[b]);
    begin_[b + 1] += begin_[b];
  }
  entries_.resize(begin_.back());
  // A mean also takes of what its own samples need: they ask for more until it gives them what they lie off.
  std::vector<float> target(entries_.size()), mean(entries_.size());
  for (size_t s = 0; s < target.size(); ++s) target[s] = entries_[s].distance;
  for (int pass = 1; pass < passes; ++pass) {
    parallel.for_each(bricks_.size(), 32, [&](size_t b) {
      const Vec3d origin(bricks_.first_vertex(b));
      for (uint32_t s = begin_[b]; s < begin_[b + 1]; ++s)
        if (const Entry& e = entries_[s]; e.weight > 0)
          mean[s] = static_cast<float>(mean_at(origin + Vec3d(e.local), Vec3d(e.normal)));
    });
    for (size_t s = 0; s < target.size(); ++s) entries_[s].distance += target[s] - mean[s];
  }
}

double Leftover::mean_at(Vec3d point, Vec3d normal) const {
  const Vec3i cell{static_cast<int>(std::floor(point.x)), static_cast<int>(std::floor(point.y)),
                   static_cast<int>(std::floor(point.z))};
  const Vec3i first = cell - Vec3i{1, 1, 1}, last = cell + Vec3i{1, 1, 1};
  const Vec3i lo = brick_of(first), hi = brick_of(last);
  double sum = 0, weights = prior;
  const auto add = [&](const Entry& entry, Vec3d at) {
    const Vec3d apart = Vec3d(entry.local) - at;
    const double near = 1 - dot(apart, apart) / (radius * radius);
    const double agreement = dot(normal, Vec3d(entry.normal));
    if (!(near > 0 && agreement > 0)) return;
    const double weight = near * near * agreement * entry.weight;
    sum += weight * entry.distance;
    weights += weight;
  };
  for (int bz = lo.z; bz <= hi.z; ++bz)
    for (int by = lo.y; by <= hi.y; ++by)
      for (int bx = lo.x; bx <= hi.x; ++bx) {
        const int32_t brick = bricks_.find({bx, by, bz});
        if (brick < 0) continue;
        const Vec3i origin = Vec3i{bx, by, bz} * brick_side;
        const Vec3d at = point - Vec3d(origin);
        const Entry* begin = entries_.data() + begin_[static_cast<size_t>(brick)];
        const Entry* end = entries_.data() + begin_[static_cast<size_t>(brick) + 1];
        const auto low = [&](int axis) { return std::max(first[axis] - origin[axis], 0); };
        const auto high = [&](int axis) { return std::min(last[axis] - origin[axis], brick_side - 1); };
        for (int z = low(2); z <= high(2); ++z)
          for (int y = low(1); y <= high(1); ++y) {
            const int until = brick_offset(high(0), y, z);
            const Entry* e = std::lower_bound(begin, end, brick_offset(low(0), y, z),
                                              [](const Entry& entry, int key) { return entry.cell < key; });
            for (; e != end && e->cell <= until; ++e) add(*e, at);
          }
      }
  return sum / weights;
}

}  // namespace soapfilm
