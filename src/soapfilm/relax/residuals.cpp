#include "soapfilm/relax/residuals.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "soapfilm/core/memory.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/share.h"
#include "soapfilm/grid/ordered_sum.h"
#include "soapfilm/kernels/robust.h"

namespace soapfilm {

namespace {

constexpr double radius = 1;   // voxels; the search visits the 27 cells around
constexpr double prior = 0.1;  // samples of distance 0 in every mean
constexpr int passes = 4;
constexpr size_t few_per_cell = 4;  // samples; with more, neighbors are merged, since the cost is quadratic
constexpr float one_sheet = 0.5f;   // cosine between the normals of two samples that may be merged

/// The eighth of its cell that a sample lies in.
int octant_of(Vec3f local) {
  const auto upper = [](float q) { return q - std::floor(q) >= 0.5f ? 1 : 0; };
  return upper(local.x) | upper(local.y) << 1 | upper(local.z) << 2;
}

/// Replaces two entries, both with some weight, by their weighted mean.
template <class Entry>
void take_together(Entry& entry, const Entry& other) {
  const float sum = entry.weight + other.weight, share = other.weight / sum;
  entry.local = entry.local + (other.local - entry.local) * share;
  entry.normal = normalized(entry.normal + (other.normal - entry.normal) * share);
  entry.distance += (other.distance - entry.distance) * share;
  entry.weight = sum;
}

/// In cells with more than a few entries, merges those in the same octant and on the same sheet of the surface; returns
/// how many are left, at the front.
template <class Entry>
size_t thin(std::span<Entry> entries) {
  size_t kept = 0;
  for (size_t first = 0; first < entries.size();) {
    size_t end = first + 1;
    while (end < entries.size() && entries[end].cell == entries[first].cell) ++end;
    const bool crowded = end - first > few_per_cell;
    for (size_t own = kept; first < end; ++first) {
      const Entry entry = entries[first];
      if (own < kept && entries[own].octant != entry.octant) own = kept;
      const auto like = std::find_if(entries.begin() + own, entries.begin() + kept, [&](const Entry& e) {
        return crowded && dot(e.normal, entry.normal) > one_sheet;
      });
      if (like == entries.begin() + kept)
        entries[kept++] = entry;
      else
        take_together(*like, entry);
    }
  }
  return kept;
}

/// Sums of distances from the surface, over samples and over pairs of neighbors.
struct PairSums {
  double pairs = 0, x = 0, y = 0, xx = 0, xy = 0;  // x = apart^2 along the surface, y = half the squared difference
  double samples = 0, power = 0;                   // power = distance^2

  void add_pair(double weight, double apart2, double half_square) {
    pairs += weight;
    x += weight * apart2;
    y += weight * half_square;
    xx += weight * apart2 * apart2;
    xy += weight * apart2 * half_square;
  }

  void add_sample(double weight, double distance) {
    samples += weight;
    power += weight * distance * distance;
  }

  PairSums& operator+=(const PairSums& o) {
    pairs += o.pairs, x += o.x, y += o.y, xx += o.xx, xy += o.xy;
    samples += o.samples, power += o.power;
    return *this;
  }

  PairSums scaled(double by) const { return {by * pairs, by * x, by * y, by * xx, by * xy, by * samples, by * power}; }

  /// The part of the mean square that is not noise. Noise is the difference of samples at one place: half their squared
  /// difference, a variogram, is noise + c apart^2 where a smooth surface is missed (its nugget; Matheron 1963).
  double share_of_surface() const {
    if (!(pairs > 0 && power > 0)) return 0;
    const double spread = pairs * xx - x * x;
    const double slope = spread > 1e-6 * pairs * xx ? std::max(0.0, (pairs * xy - x * y) / spread) : 0;
    const double noise = std::max(0.0, (y - slope * x) / pairs);
    return 1 - noise * samples / power;
  }
};

}  // namespace

Residuals::Residuals(const GridSamples& samples, const SmoothField& field, double scale, const Context& context)
    : bricks_(samples.bricks), begin_(samples.bricks.size() + 1) {
  find_entries(samples, field, static_cast<float>(scale), context);
  const std::vector<float> share = shares_of_surface(context);
  if (std::all_of(share.begin(), share.end(), [](float s) { return s == 0; })) {
    release(entries_);
    std::fill(begin_.begin(), begin_.end(), 0);
    return;
  }
  for (size_t b = 0; b < bricks_.size(); ++b)
    for (uint32_t s = begin_[b]; s < begin_[b + 1]; ++s) entries_[s].distance *= share[b];
  // A mean mixes in the residuals of other samples: the distances are adjusted until the mean at each sample is its own
  // residual.
  std::vector<float> target(entries_.size()), mean(entries_.size());
  for (size_t s = 0; s < target.size(); ++s) target[s] = entries_[s].distance;
  for (int pass = 1; pass < passes; ++pass) {
    const auto first_of = [&](size_t b) { return begin_[b]; };
    share_items(bricks_.size(), mean, 32, context, first_of, [&](size_t b) {
      const Vec3d origin(bricks_.first_vertex(b));
      for (uint32_t s = begin_[b]; s < begin_[b + 1]; ++s) {
        const Entry& e = entries_[s];
        mean[s] = static_cast<float>(mean_at(origin + Vec3d(e.local), Vec3d(e.normal)));
      }
    });
    for (size_t b = 0; b < bricks_.size(); ++b)
      for (uint32_t s = begin_[b]; s < begin_[b + 1]; ++s) entries_[s].distance += share[b] * (target[s] - mean[s]);
  }
}

/// Each rank finds those of a part of the bricks.
void Residuals::find_entries(const GridSamples& samples, const SmoothField& field, float scale,
                             const Context& context) {
  const ItemRange own = own_part(even_parts(bricks_.size(), context), context);
  const uint32_t first = samples.begin[own.begin];
  std::vector<Entry> found(samples.begin[own.end] - first);
  std::vector<uint32_t> kept(bricks_.size());
  share_values(kept, 32, context, [&](size_t b) {
    const Vec3d origin(bricks_.first_vertex(b));
    Entry* const begin = found.data() + (samples.begin[b] - first);
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
      Entry& entry = begin[s - samples.begin[b]];
      entry.local = samples.local[s];
      const Vec3i cell = cell_in_brick(entry.local);
      entry.cell = static_cast<uint16_t>(brick_offset(cell.x, cell.y, cell.z));
      entry.octant = static_cast<uint8_t>(octant_of(entry.local));
      const auto jet = field.at(origin + Vec3d(entry.local));
      if (!jet) continue;
      const Vec3f gradient(jet->gradient);
      const double slope = std::max(norm(jet->gradient), 0.3);
      if (!seen_from_outside(samples.direction[s], gradient)) continue;
      entry.normal = normalized(gradient);
      entry.distance = static_cast<float>(jet->value / slope);
      entry.weight = samples.weight_of(s) * robust_weight(Penalty::tukey, entry.distance, scale);
    }
    Entry* const end = std::remove_if(begin, found.data() + (samples.begin[b + 1] - first),
                                      [](const Entry& entry) { return !(entry.weight > 0); });
    std::stable_sort(begin, end, [](const Entry& a, const Entry& c) {
      return std::pair(a.cell, a.octant) < std::pair(c.cell, c.octant);
    });
    kept[b] = static_cast<uint32_t>(thin(std::span<Entry>(begin, end)));
  });
  for (size_t b = 0; b < bricks_.size(); ++b) begin_[b + 1] = begin_[b] + kept[b];
  for (size_t b = own.begin; b < own.end; ++b)
    std::copy_n(found.begin() + (samples.begin[b] - first), kept[b], found.begin() + (begin_[b] - begin_[own.begin]));
  found.resize(begin_[own.end] - begin_[own.begin]);
  found.shrink_to_fit();
  entries_ = lists_of_all(std::move(found), context);
}

std::vector<float> Residuals::shares_of_surface(const Context& context) const {
  constexpr double few_pairs = 20;  // what the whole surface counts for beside those around
  constexpr double nearby = 0.7;    // voxels between the samples of a pair
  constexpr double enough = 0.4;    // share of the surface in the mean square from which on distances are used in full
  std::vector<PairSums> parts(bricks_.size());
  share_values(parts, 32, context, [&](size_t b) {
    const Vec3d origin(bricks_.first_vertex(b));
    PairSums& sums = parts[b];
    for (uint32_t s = begin_[b]; s < begin_[b + 1]; ++s) {
      const Entry& own = entries_[s];
      sums.add_sample(own.weight, own.distance);
      for_each_near(origin + Vec3d(own.local), Vec3d(own.normal), [&](const Entry& other, double, double apart2) {
        const double difference = double{own.distance} - other.distance;
        if (&other != &own && apart2 < nearby * nearby)
          sums.add_pair(own.weight * other.weight, apart2, 0.5 * difference * difference);
      });
    }
  });
  const PairSums all = ordered_sum(bricks_, parts);
  const PairSums prior = all.scaled(all.pairs > 0 ? few_pairs / all.pairs : 0);
  const double most = all.share_of_surface();
  std::vector<float> shares(bricks_.size());
  parallel_for(context, bricks_.size(), 256, [&](size_t b) {
    PairSums sums = prior;
    for (const int32_t n : bricks_.neighbors(b))
      if (n >= 0) sums += parts[static_cast<size_t>(n)];
    shares[b] = static_cast<float>(std::clamp(std::min(sums.share_of_surface(), most) / enough, 0.0, 1.0));
  });
  return shares;
}

double Residuals::mean_at(Vec3d point, Vec3d normal) const {
  double sum = 0, weights = prior;
  for_each_near(point, normal, [&](const Entry& entry, double weight, double) {
    sum += weight * entry.distance;
    weights += weight;
  });
  return sum / weights;
}

template <class Visit>
void Residuals::for_each_near(Vec3d point, Vec3d normal, Visit&& visit) const {
  const Vec3i cell{static_cast<int>(std::floor(point.x)), static_cast<int>(std::floor(point.y)),
                   static_cast<int>(std::floor(point.z))};
  const Vec3i first = cell - Vec3i{1, 1, 1}, last = cell + Vec3i{1, 1, 1};
  const Vec3i lo = brick_of(first), hi = brick_of(last);
  const auto look_at = [&](const Entry& entry, Vec3d at) {
    const Vec3d apart = Vec3d(entry.local) - at;
    const double apart2 = dot(apart, apart), near = 1 - apart2 / (radius * radius);
    if (!(near > 0)) return;
    const double agreement = dot(normal, Vec3d(entry.normal));
    if (!(agreement > 0)) return;
    const double along = dot(apart, normal);
    visit(entry, near * near * agreement * entry.weight, apart2 - along * along);
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
            for (; e != end && e->cell <= until; ++e) look_at(*e, at);
          }
      }
}

}  // namespace soapfilm
