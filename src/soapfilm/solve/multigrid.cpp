#include "soapfilm/solve/multigrid.h"

#include <algorithm>

#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

/// Coarsening ends at an axis with fewer free vertices: its border alone makes the problem well conditioned.
constexpr int fewest_to_coarsen = 3;
/// Gauss-Seidel sweeps in each direction on the coarsest level.
constexpr int coarsest_sweeps = 8;

BoxAxis coarsened(const BoxAxis& axis) {
  // Intervals of the coarse axis are twice as long. An even fine vertex too close to the border is not a coarse vertex.
  const double beyond = (axis.free % 2 + axis.last) / 2;
  return beyond < 0.5 ? BoxAxis{axis.free / 2 - 1, beyond + 1} : BoxAxis{axis.free / 2, beyond};
}

enum class Color { red = 0, black = 1 };

/// Solves the equations of one color, x + y + z even (red) or odd (black); x of the other color is unchanged.
void relax(const BoxLaplacian& matrix, const DenseField<float>& b, Color color, DenseField<float>& x,
           const Context& context) {
  const Vec3i free = matrix.free();
  for_layers(free, context, [&](int z) {
    for (int y = 1; y <= free.y; ++y) {
      const int first = (1 + y + z) % 2 == static_cast<int>(color) ? 1 : 2;
      relax_row(matrix.row(y, z), rows_around(x, y, z), b.row(y, z), first, free.x, x.row(y, z));
    }
  });
}

/// The red half of a sweep that starts from x = 0. Black vertices are filled in the same way: they are solved next.
void relax_red_from_zero(const BoxLaplacian& matrix, const DenseField<float>& b, DenseField<float>& x,
                         const Context& context) {
  const Vec3i free = matrix.free();
  for_layers(free, context, [&](int z) {
    for (int y = 1; y <= free.y; ++y) {
      const RowStencils stencils = matrix.row(y, z);
      const float inverse = 1.0f / stencils.inner.sum();
      const float* in = b.row(y, z);
      float* __restrict out = x.row(y, z);
      for (int i = 1; i < free.x; ++i) out[i] = inverse * in[i];
      out[free.x] = in[free.x] / stencils.last.sum();
    }
  });
}

/// Adds `weight` times a row of the fine level, restricted along x, to a row of the coarse level.
void add_restricted(const AxisTransfer& x, const float* fine, float weight, float* __restrict coarse) {
  const int last = x.coarse.free;
  for (int i = 1; i < last; ++i) coarse[i] += weight * (fine[2 * i] + 0.5f * (fine[2 * i - 1] + fine[2 * i + 1]));
  float sum = 0.5f * fine[2 * last - 1];
  for (int i = 2 * last; i <= x.fine.free; ++i) sum += x.at(i)[0].weight * fine[i];
  coarse[last] += weight * sum;
}

/// Adds a row of the coarse level, interpolated along x, to a row of the fine level.
void add_interpolated(const AxisTransfer& x, const float* coarse, float* __restrict fine) {
  const int last = x.coarse.free;
  for (int i = 0; i < last; ++i) {
    fine[2 * i + 1] += 0.5f * (coarse[i] + coarse[i + 1]);
    fine[2 * i + 2] += coarse[i + 1];
  }
  for (int i = 2 * last + 1; i <= x.fine.free; ++i) fine[i] += x.at(i)[0].weight * coarse[last];
}

}  // namespace

AxisTransfer::AxisTransfer(const BoxAxis& axis) : fine(axis), coarse(coarsened(axis)) {}

std::array<AxisTransfer::Share, 2> AxisTransfer::at(int i) const {
  const int below = std::min(i / 2, coarse.free);
  const float way = static_cast<float>(i - 2 * below) / 2;  // in coarse cells, from the vertex below
  if (below == coarse.free) return {{{below, 1 - way / static_cast<float>(coarse.last)}, {below + 1, 0}}};
  return {{{below, below > 0 ? 1 - way : 0}, {below + 1, way}}};
}

Multigrid::Multigrid(Vec3i free) {
  std::array<BoxAxis, 3> axes{BoxAxis{free.x}, BoxAxis{free.y}, BoxAxis{free.z}};
  double scale = 1;
  levels_.push_back({BoxLaplacian(axes, scale), {}, {}});
  while (std::all_of(axes.begin(), axes.end(), [](const BoxAxis& a) { return a.free >= fewest_to_coarsen; })) {
    for (BoxAxis& axis : axes) axis = coarsened(axis);
    scale *= 2;
    const BoxLaplacian matrix(axes, scale);
    levels_.push_back({matrix, box_field(matrix.free()), box_field(matrix.free())});
  }
}

size_t Multigrid::bytes() const {
  size_t sum = 0;
  for (const Level& level : levels_) sum += level.b.bytes() + level.x.bytes();
  return sum;
}

void Multigrid::precondition(const DenseField<float>& r, DenseField<float>& z, const Context& context) {
  cycle(0, r, z, context);
}

void Multigrid::cycle(size_t l, const DenseField<float>& b, DenseField<float>& x, const Context& context) {
  const BoxLaplacian& matrix = levels_[l].matrix;
  relax_red_from_zero(matrix, b, x, context);
  relax(matrix, b, Color::black, x, context);
  if (l + 1 < levels_.size()) {
    restrict_residual(l, b, x, context);
    cycle(l + 1, levels_[l + 1].b, levels_[l + 1].x, context);
    add_correction(l, x, context);
  } else {
    for (int sweep = 1; sweep < coarsest_sweeps; ++sweep)
      for (const Color color : {Color::red, Color::black}) relax(matrix, b, color, x, context);
    for (int sweep = 1; sweep < coarsest_sweeps; ++sweep)
      for (const Color color : {Color::black, Color::red}) relax(matrix, b, color, x, context);
  }
  relax(matrix, b, Color::black, x, context);
  relax(matrix, b, Color::red, x, context);
}

void Multigrid::restrict_residual(size_t l, const DenseField<float>& b, const DenseField<float>& x,
                                  const Context& context) {
  const Level& fine = levels_[l];
  DenseField<float>& out = levels_[l + 1].b;
  const AxisTransfer along_x(fine.matrix.axis(0)), along_y(fine.matrix.axis(1)), along_z(fine.matrix.axis(2));
  const Vec3i free = fine.matrix.free();
  const Vec3i coarse = levels_[l + 1].matrix.free();
  // Each chunk owns its coarse layers and recomputes the one residual layer that it has in common with the next chunk.
  constexpr size_t layers_per_task = 8;
  parallel_chunks(context, static_cast<size_t>(coarse.z), layers_per_task, [&](size_t begin, size_t end) {
    const int first = static_cast<int>(begin) + 1, last = static_cast<int>(end);
    std::fill(out.row(0, first), out.row(0, last + 1), 0.0f);
    std::vector<float> residual(static_cast<size_t>(free.x) + 1);
    for (int z = 2 * first - 1; z <= (last == coarse.z ? free.z : 2 * last + 1); ++z) {
      for (int y = 1; y <= free.y; ++y) {
        residual_row(fine.matrix.row(y, z), rows_around(x, y, z), b.row(y, z), free.x, residual.data());
        for (const AxisTransfer::Share& to_z : along_z.at(z)) {
          if (to_z.coarse < first || to_z.coarse > last) continue;
          for (const AxisTransfer::Share& to_y : along_y.at(y))
            if (const float weight = to_z.weight * to_y.weight; weight != 0)
              add_restricted(along_x, residual.data(), weight, out.row(to_y.coarse, to_z.coarse));
        }
      }
    }
  });
}

void Multigrid::add_correction(size_t l, DenseField<float>& x, const Context& context) const {
  const Level& fine = levels_[l];
  const DenseField<float>& correction = levels_[l + 1].x;
  const AxisTransfer along_x(fine.matrix.axis(0)), along_y(fine.matrix.axis(1)), along_z(fine.matrix.axis(2));
  const Vec3i free = fine.matrix.free();
  const size_t width = static_cast<size_t>(correction.size().x);
  for_layers(free, context, [&](int z) {
    std::vector<float> sum(width);
    for (int y = 1; y <= free.y; ++y) {
      std::fill(sum.begin(), sum.end(), 0.0f);
      for (const AxisTransfer::Share& from_z : along_z.at(z))
        for (const AxisTransfer::Share& from_y : along_y.at(y)) {
          const float weight = from_z.weight * from_y.weight;
          if (weight == 0) continue;
          const float* in = correction.row(from_y.coarse, from_z.coarse);
          for (size_t i = 0; i < width; ++i) sum[i] += weight * in[i];
        }
      add_interpolated(along_x, sum.data(), x.row(y, z));
    }
  });
}

}  // namespace soapfilm
