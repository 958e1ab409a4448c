// The memory of a run, known before it starts.
#pragma once

#include <cstddef>
#include <optional>

#include "soapfilm/core/point_cloud.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/grid/lattice.h"

namespace soapfilm {

struct MemoryPlan {
  size_t input_bytes = 0;  ///< held all through: the cloud, its directions and its order on the grid
  size_t solve_bytes = 0;  ///< the peak on top of it: the finest level's band beside the coarser one
  size_t total() const;
};

/// What a reconstruction on this lattice will need. The band's size follows from the bricks that the samples reach
/// (`support_bricks`), the only part of the grid that is known before the solve.
MemoryPlan plan_memory(const PointCloud& cloud, const Lattice& lattice, size_t support_bricks);

/// What the tables that span the whole box need, whatever the samples: checked before anything is built.
size_t box_table_bytes(const Lattice& lattice);

/// Throws MemoryError when `needed` passes `limit` or, without a limit, what the machine has free; the message says
/// which resolution would fit, by the square law of a surface.
void check_memory(size_t needed, std::optional<size_t> limit, size_t held, const Lattice& lattice);

}  // namespace soapfilm
