// All collapses at one distance: tiles of space side by side, then larger and shifted ones.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/simplify/trial.h"

namespace soapfilm {

/// Collapses edges in order of their cost, tile by tile. A collapse needs its triangles in the tile; one that reaches
/// beyond waits for a round of other tiles, of which the last is the whole. What a tile does depends neither on the
/// others nor on threads. `waiting`, by vertex: only edges with such an end.
void collapse_edges(CollapseRun& run, std::vector<uint8_t> waiting, const Context& context);

}  // namespace soapfilm
