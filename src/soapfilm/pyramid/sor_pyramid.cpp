#include "soapfilm/pyramid/sor_pyramid.h"

#include <algorithm>
#include <utility>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/pyramid/restrict.h"

namespace soapfilm {

namespace {

constexpr float near_weight = 0.75f, far_weight = 0.25f;

/// The coarse vertices around fine vertex x (lattice coordinates): the one that holds it and the next nearest.
struct Parents {
  int near, far;
  explicit Parents(int x) : near(x >> 1), far((x >> 1) + 2 * (x & 1) - 1) {}
};

/// Adds `weight` times the row (Y, Z) of `coarse` to `out`; nothing beyond the box.
void add_row(const DenseField<float>& coarse, int Y, int Z, float weight, std::vector<float>& out) {
  const int y = Y - coarse.origin().y, z = Z - coarse.origin().z;
  if (y < 0 || z < 0 || y >= coarse.size().y || z >= coarse.size().z) return;
  const float* row = coarse.row(y, z);
  for (size_t x = 0; x < out.size(); ++x) out[x] += weight * row[x];
}

}  // namespace

DenseField<float> prolong_dense(const DenseField<float>& coarse, const LevelBox& fine_box, const Context& context) {
  DenseField<float> fine(fine_box, pages_of(context));
  const Vec3i size = fine.size(), origin = fine.origin();
  parallel_for(context, static_cast<size_t>(size.z - 2), 1, [&](size_t layer) {
    const int z = static_cast<int>(layer) + 1;
    std::vector<float> blend(static_cast<size_t>(coarse.size().x));
    const auto blended = [&](int X) {
      const int x = X - coarse.origin().x;
      return x < 0 || x >= coarse.size().x ? 0.0f : blend[static_cast<size_t>(x)];
    };
    for (int y = 1; y < size.y - 1; ++y) {
      const Parents py(origin.y + y), pz(origin.z + z);
      std::fill(blend.begin(), blend.end(), 0.0f);
      add_row(coarse, py.near, pz.near, near_weight * near_weight, blend);
      add_row(coarse, py.far, pz.near, far_weight * near_weight, blend);
      add_row(coarse, py.near, pz.far, near_weight * far_weight, blend);
      add_row(coarse, py.far, pz.far, far_weight * far_weight, blend);
      float* row = fine.row(y, z);
      for (int x = 1; x < size.x - 1; ++x) {
        const Parents px(origin.x + x);
        row[x] = near_weight * blended(px.near) + far_weight * blended(px.far);
      }
    }
  });
  return fine;
}

Level solve_sor(const Lattice& lattice, const SupportField& support, double lambda, const SorParams& params,
                const Context& context, std::vector<SorLevelReport>& reports, const SorObserver& observe) {
  validate(params);
  const int levels = std::min(params.levels, lattice.levels);
  const std::vector<SupportField> coarser = coarser_fields(support, lattice, levels, context);
  DenseField<float> u(lattice.box(levels - 1), pages_of(context));
  for (int l = levels - 1; l >= 0; --l) {
    const LevelBox box = lattice.box(l);
    if (l < levels - 1) u = prolong_dense(u, box, context);
    const SupportField& data = l == 0 ? support : coarser[static_cast<size_t>(l - 1)];
    reports.push_back(relax_sor(u, box, lambda * face_area(l), data, params, context, observe));
  }
  return sor_level(u, lattice.box(0), lambda, support, params, context);
}

}  // namespace soapfilm
