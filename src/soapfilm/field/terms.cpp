#include "soapfilm/field/terms.h"

#include <array>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

/// One kind of evidence, from the samples on the finest level.
struct LinearTerm {
  BrickMask (*bricks)(const GridSamples& samples, const LevelBox& box, const Context& context);  ///< where it is not 0
  SupportField (*field)(const GridSamples& samples, const LevelBox& box, const Context& context);
};

constexpr std::array terms = {LinearTerm{support_mask, divergence_field}};

}  // namespace

SupportField data_field(const GridSamples& samples, const LevelBox& box, const Context& context) {
  SupportField sum = terms[0].field(samples, box, context);
  for (size_t k = 1; k < terms.size(); ++k) sum = sum_of(sum, terms[k].field(samples, box, context), context);
  return sum;
}

BrickMask data_bricks(const GridSamples& samples, const LevelBox& box, const Context& context) {
  BrickMask bricks = terms[0].bricks(samples, box, context);
  for (size_t k = 1; k < terms.size(); ++k) bricks |= terms[k].bricks(samples, box, context);
  return bricks;
}

SupportField sum_of(const SupportField& a, const SupportField& b, const Context& context) {
  BrickMask both(a.grid.bricks());
  add_bricks(a.grid, both);
  add_bricks(b.grid, both);
  SupportField sum;
  sum.grid = BrickGrid(both, context);
  sum.f = Field<float>(sum.grid, pages_of(context));
  parallel_for(context, sum.grid.size(), 256, [&](size_t k) {
    for (const SupportField* part : {&a, &b})
      if (const int32_t n = part->grid.find(sum.grid.coord(k)); n >= 0) {
        const float* f = part->f.brick(static_cast<size_t>(n));
        for (int i = 0; i < brick_volume; ++i) sum.f.brick(k)[i] += f[i];
      }
  });
  return sum;
}

}  // namespace soapfilm
