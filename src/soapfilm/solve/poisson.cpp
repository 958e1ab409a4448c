#include "soapfilm/solve/poisson.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/error.h"
#include "soapfilm/solve/multigrid.h"

namespace soapfilm {

namespace {

void validate(double lambda, const PoissonParams& params) {
  if (!(lambda > 0) || !std::isfinite(lambda)) throw ParameterError(fmt::format("lambda = {:g}, must be > 0", lambda));
  if (!(params.tolerance > 0 && params.tolerance < 1))
    throw ParameterError(fmt::format("tolerance = {:g}, must be in (0, 1)", params.tolerance));
  if (params.max_iterations < 1)
    throw ParameterError(fmt::format("max_iterations = {}, must be >= 1", params.max_iterations));
}

/// Dot product over a row's free vertices, as eight partial sums, so that the order is fixed for SIMD lanes.
double dot_row(const float* a, const float* b, int free) {
  constexpr int lanes = 8;
  double partial[lanes] = {};
  int i = 1;
  for (; i + lanes <= free + 1; i += lanes)
    for (int k = 0; k < lanes; ++k) partial[k] += static_cast<double>(a[i + k]) * static_cast<double>(b[i + k]);
  double sum =
      ((partial[0] + partial[4]) + (partial[1] + partial[5])) + ((partial[2] + partial[6]) + (partial[3] + partial[7]));
  for (; i <= free; ++i) sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  return sum;
}

/// The steps of conjugate gradients on whole fields; every sum is over rows, then layers, in fixed order.
class FieldAlgebra {
 public:
  FieldAlgebra(const BoxLaplacian& matrix, const Context& context)
      : matrix_(matrix), free_(matrix.free()), context_(context), layer_sums_(static_cast<size_t>(free_.z)) {}

  double dot(const DenseField<float>& a, const DenseField<float>& b) {
    return sum_rows([&](int y, int z) { return dot_row(a.row(y, z), b.row(y, z), free_.x); });
  }

  /// p = z + beta p
  void renew_direction(const DenseField<float>& z, double beta, DenseField<float>& p) {
    const auto factor = static_cast<float>(beta);
    for_rows([&](int row_y, int row_z) {
      const float* in = z.row(row_y, row_z);
      float* __restrict out = p.row(row_y, row_z);
      for (int i = 1; i <= free_.x; ++i) out[i] = in[i] + factor * out[i];
    });
  }

  /// q = A p; returns <p, q>.
  double apply(const DenseField<float>& p, DenseField<float>& q) {
    return sum_rows([&](int y, int z) {
      apply_row(matrix_.row(y, z), rows_around(p, y, z), free_.x, q.row(y, z));
      return dot_row(p.row(y, z), q.row(y, z), free_.x);
    });
  }

  /// u += alpha p, r -= alpha q; returns <r, r>.
  double step(double alpha, const DenseField<float>& p, const DenseField<float>& q, DenseField<float>& u,
              DenseField<float>& r) {
    const auto length = static_cast<float>(alpha);
    return sum_rows([&](int y, int z) {
      add(length, p.row(y, z), u.row(y, z));
      add(-length, q.row(y, z), r.row(y, z));
      return dot_row(r.row(y, z), r.row(y, z), free_.x);
    });
  }

  /// r = b - A u, in place of b; returns <r, r>.
  double residual(const DenseField<float>& u, DenseField<float>& r) {
    return sum_rows([&](int y, int z) {
      residual_row(matrix_.row(y, z), rows_around(u, y, z), r.row(y, z), free_.x, r.row(y, z));
      return dot_row(r.row(y, z), r.row(y, z), free_.x);
    });
  }

 private:
  void add(float factor, const float* in, float* __restrict out) const {
    for (int i = 1; i <= free_.x; ++i) out[i] += factor * in[i];
  }

  template <class Row>
  void for_rows(Row&& row) {
    for_layers(free_, context_, [&](int z) {
      for (int y = 1; y <= free_.y; ++y) row(y, z);
    });
  }

  template <class Row>
  double sum_rows(Row&& row) {
    for_layers(free_, context_, [&](int z) {
      double sum = 0;
      for (int y = 1; y <= free_.y; ++y) sum += row(y, z);
      layer_sums_[static_cast<size_t>(z) - 1] = sum;
    });
    double total = 0;
    for (const double sum : layer_sums_) total += sum;
    return total;
  }

  const BoxLaplacian& matrix_;
  Vec3i free_;
  const Context& context_;
  std::vector<double> layer_sums_;
};

/// b = f / (2 lambda): the matrix is then the plain 7-point stencil.
void fill_data(const SupportField& support, double lambda, DenseField<float>& b, const Context& context) {
  std::fill(b.data(), b.data() + b.count(), 0.0f);
  const auto scale = static_cast<float>(1 / (2 * lambda));
  parallel_for(context, support.grid.size(), 64, [&](size_t brick) {
    for_each_run(b, support.grid.coord(brick), [&](float* row, int x, int y, int z, int n) {
      const float* f = support.f.brick(brick) + brick_offset(x, y, z);
      for (int i = 0; i < n; ++i) row[i] = scale * f[i];
    });
  });
}

}  // namespace

DenseField<float> solve_poisson(const Lattice& lattice, const SupportField& support, double lambda,
                                const PoissonParams& params, const Context& context, PoissonReport& report) {
  validate(lambda, params);
  const LevelBox box = lattice.box(0);
  const Vec3i free = box.free_hi - box.free_lo + Vec3i{1, 1, 1};
  Multigrid multigrid(free);
  FieldAlgebra fields(multigrid.matrix(), context);
  const PagePool& pages = pages_of(context);
  DenseField<float> u(box, pages), r(box, pages), p(box, pages), z(box, pages);
  report = {};
  report.unknowns = static_cast<size_t>(free.x) * static_cast<size_t>(free.y) * static_cast<size_t>(free.z);
  report.bytes = u.bytes() + r.bytes() + p.bytes() + z.bytes() + multigrid.bytes();

  fill_data(support, lambda, r, context);
  const double b_b = fields.dot(r, r);
  double r_r = b_b, r_z = 0;
  const auto relative = [&] { return b_b > 0 ? std::sqrt(r_r / b_b) : 0.0; };
  while (report.iterations < params.max_iterations && relative() > params.tolerance) {
    context.check();
    multigrid.precondition(r, z, context);
    const double previous = std::exchange(r_z, fields.dot(r, z));
    fields.renew_direction(z, previous > 0 ? r_z / previous : 0.0, p);
    DenseField<float>& q = z;  // z is not needed any more: saves one field
    const double alpha = r_z / fields.apply(p, q);
    r_r = fields.step(alpha, p, q, u, r);
    ++report.iterations;
    report.residuals.push_back(relative());
    context.progress().advance(std::min(1.0, std::log(relative()) / std::log(params.tolerance)),
                               fmt::format("{} iterations, residual {:.1e}", report.iterations, relative()));
  }

  // The r of the recurrence drifts from the true one by rounding: the reported residual is computed again.
  fill_data(support, lambda, r, context);
  const double b_u = fields.dot(r, u);
  r_r = fields.residual(u, r);
  report.residual = relative();
  report.converged = report.residual <= params.tolerance;
  // E(u) = <u, A u> / 2 - <b, u> in units of 2 lambda, and A u = b - r.
  report.energy = -lambda * (b_u + fields.dot(r, u));
  return u;
}

}  // namespace soapfilm
