#include "soapfilm/solve/band_graph.h"

#include <fmt/core.h>

#include <bit>
#include <limits>

#include "soapfilm/core/bits.h"
#include "soapfilm/error.h"

namespace soapfilm {

namespace {

BrickMask bricks_of(const VertexMask& band) {
  BrickMask bricks(band.bricks());
  const Vec3i n = band.bricks();
  for (int z = 0; z < brick_side * n.z; ++z)
    for (int y = 0; y < brick_side * n.y; ++y)
      for (int x = 0; x < n.x; ++x)
        if (band.row(x, y, z) != 0) bricks.set({x, y >> 3, z >> 3});
  return bricks;
}

}  // namespace

BandGraph::BandGraph(const VertexMask& band, const LevelBox& box, const SupportField& support,
                     const std::vector<Link>& links, const Context& context)
    : box_(box),
      support_(support),
      links_(links),
      grid_(bricks_of(band), context),
      rows_(grid_.size() * rows_per_brick),
      f_brick_(grid_.size()) {
  uint64_t count = 0;
  for (size_t b = 0; b < grid_.size(); ++b) {
    const Vec3i brick = grid_.coord(b);
    f_brick_[b] = support.grid.find(brick);
    for (int r = 0; r < brick_area; ++r) {
      const uint8_t bits =
          band.row(brick.x, brick_side * brick.y + r % brick_side, brick_side * brick.z + r / brick_side);
      rows_[b * rows_per_brick + static_cast<size_t>(r)] = {static_cast<uint32_t>(count), bits};
      count += static_cast<uint64_t>(count_bits(bits));
    }
  }
  // Edges are numbered in 32 bits: one each way per link, and two for the link to a terminal.
  const uint64_t most = std::numeric_limits<uint32_t>::max() / (links.size() + 2);
  if (count > most)
    throw ParameterError(
        fmt::format("graph cut: the band has {} vertices, must be <= {} with {} neighbors", count, most, links.size()));
  vertices_ = static_cast<uint32_t>(count);
}

bool BandGraph::Cursor::next(BandVertex& vertex) {
  while (bits_ == 0) {
    if (row_ == graph_.rows_.size()) return false;
    bits_ = graph_.rows_[row_++].bits;
  }
  const size_t row = row_ - 1;
  const size_t brick = row / rows_per_brick;
  const int in_brick = static_cast<int>(row % rows_per_brick);
  const Vec3i local{std::countr_zero(bits_), in_brick % brick_side, in_brick / brick_side};
  bits_ &= bits_ - 1;
  vertex.id = id_++;
  graph_.measure_surroundings(vertex, brick, local);
  return true;
}

void BandGraph::measure_surroundings(BandVertex& vertex, size_t brick, Vec3i local) const {
  vertex.position = grid_.first_vertex(brick) + local;
  const int32_t f = f_brick_[brick];
  vertex.unary =
      f < 0 ? 0.0
            : -static_cast<double>(support_.f.brick(static_cast<size_t>(f))[brick_offset(local.x, local.y, local.z)]);
  vertex.links = 0;
  for (size_t d = 0; d < links_.size(); ++d) {
    const Vec3i step = links_[d].step;
    if (!box_.is_free(vertex.position + step)) {
      vertex.unary += links_[d].weight;
      continue;
    }
    const Vec3i at = local + step;
    const Vec3i over = brick_of(at);
    const int32_t b = grid_.neighbors(brick)[static_cast<size_t>(neighbor_slot(over.x, over.y, over.z))];
    if (b < 0) continue;
    const Row& row = rows_[static_cast<size_t>(b) * rows_per_brick + static_cast<size_t>((at.y & 7) + 8 * (at.z & 7))];
    const unsigned bit = 1u << (at.x & 7);
    if (!(row.bits & bit)) continue;
    vertex.links |= 1u << d;
    vertex.neighbor[d] = row.before + static_cast<uint32_t>(count_bits(row.bits & (bit - 1)));
  }
}

}  // namespace soapfilm
