#include "soapfilm/refine/fit/multilevel.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "soapfilm/core/parallel.h"
#include "soapfilm/refine/fit/layers.h"

namespace soapfilm {

namespace {

constexpr size_t coarsest_rows = 64;
constexpr size_t most_levels = 8;
constexpr int coarsest_steps = 8;
constexpr float damping = 0.8f;

/// Bits of the coarse vertices from which a fine row's vertices interpolate, from coarse vertex 4 (brick's x) on.
unsigned coarse_bits(unsigned fine_mask) {
  unsigned bits = 0;
  for (unsigned x = 0; x < brick_side; ++x)
    if (fine_mask >> x & 1) bits |= 1u << (x / 2) | 1u << ((x + 1) / 2);
  return bits;
}

/// Calls visit(coarse y relative to the parent brick) for the one or two coarse rows of a fine coordinate.
template <class Visit>
void for_each_parent(int fine, Visit&& visit) {
  visit(fine >> 1);
  if (fine & 1) visit((fine >> 1) + 1);
}

/// The values of the rows at hand.
RowRange values_at_hand(const NarrowBand& band) {
  const RowRange rows = rows_at_hand(band);
  return {rows.begin * brick_side, rows.end * brick_side};
}

void multiply(const RowArray& a, const RowArray& b, RowArray& out, const Context& context) {
  parallel_chunks(context, a.size(), rows_per_task * brick_side, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) out.data()[i] = a.data()[i] * b.data()[i];
  });
}

/// Of the rows at hand.
void clear(const NarrowBand& band, RowArray& array, const Context& context) {
  const RowRange rows = values_at_hand(band);
  float* const first = array.data() + rows.begin;
  parallel_chunks(context, rows.end - rows.begin, rows_per_task * brick_side,
                  [&](size_t begin, size_t end) { std::fill(first + begin, first + end, 0.0f); });
}

/// The coarse bricks from which the fine ones interpolate.
BrickGrid coarse_bricks(const NarrowBand& fine, const Context& context) {
  const BrickGrid& grid = fine.grid();
  const Vec3i box = grid.bricks();
  // A fine brick touches its parent and, where it is the upper half, the parent's upper neighbors.
  BrickMask mask({box.x / 2 + 2, box.y / 2 + 2, box.z / 2 + 2});
  parallel_for(context, grid.size(), 256, [&](size_t b) {
    if (fine.first_row(b) == fine.first_row(b + 1)) return;
    const Vec3i c = grid.coord(b);
    for (int k = 0; k < 8; ++k) {
      const Vec3i up{octant_of(k).x & c.x, octant_of(k).y & c.y, octant_of(k).z & c.z};
      mask.set_shared(parent_of(c) + up);
    }
  });
  return BrickGrid(mask, context);
}

/// Where a fine brick's first vertex lies in its parent: 0 or 4 along each axis.
Vec3i place_in_parent(const NarrowBand& fine, size_t brick) {
  return octant_base(octant_in_parent(fine.grid().coord(brick)));
}

/// Marks the coarse vertices from which a fine brick's rows interpolate: a byte per row of a coarse brick.
void mark_coarse(const NarrowBand& fine, size_t brick, const BrickGrid& coarse, int32_t parent,
                 std::vector<uint8_t>& vertices) {
  const Vec3i half = place_in_parent(fine, brick);
  const auto& around = coarse.neighbors(static_cast<size_t>(parent));
  for (uint32_t r = fine.first_row(brick); r < fine.first_row(brick + 1); ++r) {
    const unsigned bits = coarse_bits(fine.mask(r)) << half.x;
    for_each_parent(fine.place(r) >> 3, [&](int cz) {
      for_each_parent(fine.place(r) & 7, [&](int cy) {
        const int y = half.y + cy, z = half.z + cz;
        for (int up = 0; up < 2; ++up) {
          const unsigned part = bits >> (8 * up) & 0xff;
          const int32_t there = around[static_cast<size_t>(neighbor_slot(up, y >> 3, z >> 3))];
          if (part != 0)
            vertices[static_cast<size_t>(there) * brick_area + static_cast<size_t>((y & 7) + 8 * (z & 7))] |=
                static_cast<uint8_t>(part);
        }
      });
    });
  }
}

}  // namespace

CoarseBand::CoarseBand(const NarrowBand& fine, const Context& context) {
  const BrickGrid& grid = fine.grid();
  const int layers = layers_of(fine);
  const auto for_bricks = [&](int layer, auto&& body) {
    const auto [begin, end] = fine.layers()[layer];
    for (size_t b = begin; b < end; ++b)
      if (fine.first_row(b) < fine.first_row(b + 1)) body(b);
  };
  BrickGrid coarse = coarse_bricks(fine, context);
  std::vector<int32_t> parent(grid.size());  // brick that holds a fine brick's first vertex
  parallel_for(context, grid.size(), 256, [&](size_t b) { parent[b] = coarse.find(parent_of(grid.coord(b))); });
  std::vector<uint8_t> vertices(coarse.size() * brick_area);
  for_even_then_odd_layers(layers, context, [&](int layer) {
    for_bricks(layer, [&](size_t b) { mark_coarse(fine, b, coarse, parent[b], vertices); });
  });
  band_ = NarrowBand(std::move(coarse), vertices, context);
  fine_layers_ = fine.layers_at_hand();
  if (fine.slabs()) {
    complete_ = fine.slabs()->halved();
    if (complete_->suit(band_.grid())) band_.share_out(complete_);
  }

  first_transfer_.assign(1, 0);
  for (int layer = 0; layer < layers; ++layer) {
    size_t count = 0;
    for_bricks(layer, [&](size_t) { ++count; });
    first_transfer_.push_back(first_transfer_.back() + count);
  }
  transfers_.resize(first_transfer_.back());
  parallel_for(context, static_cast<size_t>(layers), 1, [&](size_t layer) {
    size_t next = first_transfer_[layer];
    for_bricks(static_cast<int>(layer), [&](size_t b) { transfers_[next++] = make_transfer(fine, b, parent[b]); });
  });
}

BrickTransfer CoarseBand::make_transfer(const NarrowBand& fine, size_t brick, int32_t parent) const {
  constexpr int side = BrickTransfer::side;
  const uint32_t first = fine.first_row(brick);
  const Vec3i half = place_in_parent(fine, brick);
  BrickTransfer transfer{{}, {}, half.x, first, fine.first_row(brick + 1) - first, fine.places() + first};
  const auto& around = band_.grid().neighbors(static_cast<size_t>(parent));
  // Four rows along y lie in one coarse brick, the fifth there too or in the next one.
  const auto gather_rows = [&](int x, auto& rows) {
    for (int z = 0; z < side; ++z) {
      const int coarse_z = half.z + z;
      const auto there = [&](int y) {
        return band_.rows_of(around[static_cast<size_t>(neighbor_slot(x, y >> 3, coarse_z >> 3))]) + (y & 7) +
               brick_side * (coarse_z & 7);
      };
      std::copy_n(there(half.y), side - 1, rows.data() + side * z);
      rows[static_cast<size_t>(side * z + side - 1)] = *there(half.y + side - 1);
    }
  };
  gather_rows(0, transfer.row);
  if (half.x != 0) gather_rows(1, transfer.right);
  return transfer;
}

void CoarseBand::restrict_to(const RowArray& from, RowArray& coarse, const Context& context) const {
  clear(band_, coarse, context);
  for_even_then_odd_layers(fine_layers_, context, [&](int layer) { restrict_layer(layer, from, coarse); });
  collect(coarse);
}

void CoarseBand::collect(RowArray& coarse) const {
  if (!complete_) return;
  constexpr int beside = NarrowBand::layers_beside;
  const ItemRange all{1, band_.rows() + 1};
  bring(complete_->ranks(), complete_->parts([&](Layers layers) { return rows_of(band_, layers); }),
        complete_->parts(
            [&](Layers layers) { return band_.slabs() ? rows_of(band_, layers.widened(beside, beside)) : all; }),
        {{coarse.data(), brick_side * sizeof(float)}});
}

void CoarseBand::restrict_layer(int layer, const RowArray& from, RowArray& coarse) const {
  const RowKernel& kernel = band_.kernel();
  for (const BrickTransfer& transfer : of_layer(layer)) kernel.restrict_brick(transfer, from.data(), coarse.data());
}

void CoarseBand::restrict_residual(int layer, const NarrowBand& fine, const CycleJob& job, RowArray& coarse) const {
  const RowKernel& kernel = band_.kernel();
  for (const BrickTransfer& transfer : of_layer(layer))
    kernel.restrict_residual(fine.view(), job, transfer, coarse.data());
}

void CoarseBand::prolong_onto(int layer, const NarrowBand& fine, const CycleJob& job) const {
  const RowKernel& kernel = band_.kernel();
  for (const BrickTransfer& transfer : of_layer(layer)) kernel.prolong_brick(fine.view(), job, transfer);
}

Multilevel::Multilevel(const NarrowBand& fine, const Context& context)
    : fine_(fine), inverse_(fine.make_array()), work_(fine.make_array()) {
  RowArray ones = fine.make_array();
  for_rows(rows_at_hand(fine), context, [&](size_t begin, size_t end) {
    for (size_t r = begin; r < end; ++r)
      for (size_t x = 0; x < brick_side; ++x)
        ones.data()[r * brick_side + x] = static_cast<float>(fine.mask(static_cast<uint32_t>(r)) >> x & 1);
  });
  while (band(coarse_.size()).rows() > coarsest_rows && coarse_.size() < most_levels) {
    const NarrowBand& finer = band(coarse_.size());
    Coarse next;
    next.coarse = CoarseBand(finer, context);
    const NarrowBand& coarse = next.coarse.band();
    for (RowArray* array : {&next.extent, &next.inverse, &next.b, &next.x, &next.work}) *array = coarse.make_array();
    next.coarse.restrict_to(coarse_.empty() ? ones : coarse_.back().extent, next.extent, context);
    coarse_.push_back(std::move(next));
  }
}

void Multilevel::set_operator(const RowArray& position_weights, float beta, float gamma, const Context& context) {
  diffusion_ = std::sqrt(gamma);
  reaction_ = 0.5f * beta / diffusion_;
  even_ = !coarse_.empty() && weigh_little(position_weights);
  if (!even_) set_inverse(0, position_weights, context);
  for (size_t l = 1; l <= coarse_.size(); ++l) {
    Coarse& c = coarse_[l - 1];
    c.coarse.restrict_to(l == 1 ? position_weights : coarse_[l - 2].b, c.b, context);
    set_inverse(l, c.b, context);
  }
}

/// Whether the position weights are small relative to the diagonal of the finest level, on average where they are not
/// 0.
bool Multilevel::weigh_little(const RowArray& position_weights) const {
  constexpr double most_share = 0.25;
  double sum = 0;
  size_t count = 0;
  for (const auto& row : values_in(fine_, position_weights, some_rows(fine_)))
    for (const float weight : row) {
      sum += static_cast<double>(weight);
      count += weight > 0;
    }
  const double most = most_share * 6 * static_cast<double>(diffusion_);
  return sum <= most * most * static_cast<double>(count);
}

bool Multilevel::local_mean(const std::function<void(int)>& complete, const RowArray& values, const RowArray& weights,
                            const RowArray& where, float scale, RowArray& mean, const Context& context) {
  constexpr float spread = 0.125f;  // to each neighbor per pass
  if (coarse_.empty()) return false;
  Coarse& c = coarse_.front();
  const NarrowBand& band = c.coarse.band();
  clear(band, c.b, context);
  clear(band, c.x, context);
  layer_by_layer(fine_.layers_at_hand(), context, complete, EvenOddStage{[&](int layer) {
                   c.coarse.restrict_layer(layer, values, c.b);
                   c.coarse.restrict_layer(layer, weights, c.x);
                 }});
  c.coarse.collect(c.b);
  c.coarse.collect(c.x);
  // Two passes of diffusion, each one voxel^2; restricting and interpolating are the third.
  for (RowArray* sums : {&c.b, &c.x}) {
    apply_laplacian(band, *sums, 1, -spread, c.work, context);
    apply_laplacian(band, c.work, 1, -spread, *sums, context);
  }
  const RowRange all = values_at_hand(band);
  parallel_chunks(context, all.end - all.begin, rows_per_task * brick_side, [&](size_t begin, size_t end) {
    for (size_t i = all.begin + begin; i < all.begin + end; ++i)
      c.b.data()[i] = c.x.data()[i] > 0 ? scale * (c.b.data()[i] / c.x.data()[i]) : 0.0f;
  });
  CycleJob job{};
  job.inverse = where.data();
  job.x = c.b.data();
  job.out = mean.data();
  layer_by_layer(fine_.layers_at_hand(), context, [&](int layer) { c.coarse.prolong_onto(layer, fine_, job); });
  return true;
}

void Multilevel::set_inverse(size_t level, const RowArray& weights, const Context& context) {
  const NarrowBand& band = this->band(level);
  const InverseJob job{level == 0 ? nullptr : coarse_[level - 1].extent.data(),
                       weights.data(),
                       diffusion_ / static_cast<float>(face_area(static_cast<int>(level))),
                       reaction_,
                       damping,
                       (level == 0 ? inverse_ : coarse_[level - 1].inverse).data()};
  const RowKernel& kernel = band.kernel();
  for_rows(rows_at_hand(band), context,
           [&](size_t begin, size_t end) { kernel.inverse(band.view(), job, begin, end); });
}

double Multilevel::apply(const std::function<void(int)>& complete, const RowArray& r, RowArray& z, RowArray& work,
                         const Context& context) {
  const LayerRange layers = fine_.layers_at_hand();
  if (coarse_.empty()) {
    layer_by_layer(layers, context, complete);
    solve_coarsest(r, work_, work, nullptr, context);
    return solve_coarsest(work, work_, z, &r, context);
  }
  Coarse& next = coarse_.front();
  const auto restricted = [&](const RowArray& b) {
    return EvenOddStage{[&](int layer) { next.coarse.restrict_residual(layer, fine_, job(0, b), next.b); }};
  };
  clear(next.coarse.band(), next.b, context);
  layer_by_layer(layers, context, complete, restricted(r));
  correct(0, r, work_, work, nullptr, context, restricted(work));
  return correct(0, work, work_, z, &r, context);
}

CycleJob Multilevel::job(size_t level, const RowArray& b) const {
  CycleJob job{};
  if (level == 0 && even_) {
    job.step = damping / (6 * diffusion_ + reaction_);
    job.reaction = reaction_;
  } else {
    job.inverse = (level == 0 ? inverse_ : coarse_[level - 1].inverse).data();
  }
  job.extent = level == 0 ? nullptr : coarse_[level - 1].extent.data();
  job.b = b.data();
  job.diffusion = diffusion_ / static_cast<float>(face_area(static_cast<int>(level)));
  job.omega = damping;
  return job;
}

void Multilevel::solve(size_t level, const RowArray& b, RowArray& work, RowArray& x, const Context& context) {
  if (level == coarse_.size()) {
    solve_coarsest(b, work, x, nullptr, context);
    return;
  }
  Coarse& c = coarse_[level];
  clear(c.coarse.band(), c.b, context);
  // The step from zero is stored, since each of its values is read seven times.
  const Coarse& own = coarse_[level - 1];
  CycleJob job = this->job(level, b);
  job.x = x.data();
  job.extended = work.data();
  layer_by_layer(
      band(level).layers_at_hand(), context,
      [&](int layer) {
        const auto [begin, end] = rows_of_layer(band(level), layer);
        for (size_t i = begin * brick_side; i < end * brick_side; ++i) {
          x.data()[i] = own.inverse.data()[i] * b.data()[i];
          work.data()[i] = x.data()[i] * own.extent.data()[i];
        }
      },
      EvenOddStage{[&](int layer) { c.coarse.restrict_residual(layer, band(level), job, c.b); }});
  correct(level, b, work, x, nullptr, context);
}

double Multilevel::solve_coarsest(const RowArray& b, RowArray& work, RowArray& x, const RowArray* weight,
                                  const Context& context) {
  const size_t level = coarse_.size();
  const NarrowBand& band = this->band(level);
  multiply(level == 0 ? inverse_ : coarse_.back().inverse, b, x, context);
  double sum = 0;
  const auto smooth = [&](const RowArray& from, RowArray& to) {
    CycleJob job = this->job(level, b);
    job.x = from.data();
    job.out = to.data();
    job.weight = weight ? weight->data() : nullptr;
    const RowKernel& kernel = band.kernel();
    sum = sum_over_rows(band, [&](size_t begin, size_t end) { return kernel.smooth(band.view(), job, begin, end); });
  };
  for (int step = 0; step < coarsest_steps; step += 2) {
    smooth(x, work);
    smooth(work, x);
  }
  return sum;
}

template <class... Stages>
double Multilevel::correct(size_t level, const RowArray& b, RowArray& work, RowArray& x, const RowArray* weight,
                           const Context& context, Stages&&... after) {
  Coarse& c = coarse_[level];
  const NarrowBand& band = this->band(level);
  c.coarse.collect(c.b);
  solve(level + 1, c.b, c.work, c.x, context);
  if constexpr (sizeof...(Stages) > 0) clear(c.coarse.band(), c.b, context);
  CycleJob prolong = job(level, b), smooth = prolong;
  prolong.x = c.x.data();
  prolong.out = work.data();
  smooth.x = work.data();
  smooth.out = x.data();
  smooth.weight = weight ? weight->data() : nullptr;
  LayerSums sums(band);
  const RowKernel& kernel = band.kernel();
  layer_by_layer(
      band.layers_at_hand(), context, [&](int layer) { c.coarse.prolong_onto(layer, band, prolong); },
      [&](int layer) {
        sums.add(layer, [&](size_t begin, size_t end) { return kernel.smooth(band.view(), smooth, begin, end); });
      },
      after...);
  return weight ? sums.total() : 0;  // else nobody asks for it
}

}  // namespace soapfilm
