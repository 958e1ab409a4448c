#include "soapfilm/pyramid/restrict.h"

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/share.h"
#include "soapfilm/device/device.h"
#include "soapfilm/grid/bring_bricks.h"

namespace soapfilm {

namespace {

/// Adds a child brick to its octant of the coarse brick.
void add_child(const float* child, Vec3i octant, float* coarse) {
  const Vec3i base = octant_base(octant);
  for (int z = 0; z < brick_side; ++z)
    for (int y = 0; y < brick_side; ++y)
      for (int x = 0; x < brick_side; ++x)
        coarse[brick_offset(base.x + x / 2, base.y + y / 2, base.z + z / 2)] += child[brick_offset(x, y, z)];
}

}  // namespace

SupportField restrict_field(const SupportField& fine, const LevelBox& coarse_box, const Context& context) {
  SupportField coarse;
  coarse.grid = BrickGrid(parents_of(fine.grid, coarse_box.bricks, context), context);
  coarse.f = Field<float>(coarse.grid, pages_of(context));
  if (const Device* device = device_of(context); device && device->restrict_data(fine, coarse, context)) return coarse;
  const ItemRange own = own_part(even_parts(coarse.grid.size(), context), context);
  parallel_for(context, own.size(), 64, [&](size_t i) {
    const size_t b = own.begin + i;
    for (int k = 0; k < 8; ++k) {
      const int32_t child = fine.grid.find(child_of(coarse.grid.coord(b), k));
      if (child >= 0) add_child(fine.f.brick(static_cast<size_t>(child)), octant_of(k), coarse.f.brick(b));
    }
  });
  bring_bricks(coarse.f, context);
  return coarse;
}

std::vector<SupportField> coarser_fields(const SupportField& finest, const Lattice& lattice, int levels,
                                         const Context& context) {
  std::vector<SupportField> fields;
  fields.reserve(static_cast<size_t>(levels));
  for (int l = 1; l < levels; ++l)
    fields.push_back(restrict_field(l == 1 ? finest : fields.back(), lattice.box(l), context));
  return fields;
}

}  // namespace soapfilm
