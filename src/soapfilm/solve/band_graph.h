// The vertices of a band as the nodes of a graph: numbered brick after brick, with links to the neighbors of a fixed
// set of directions. Links are not stored: a cursor computes them each time.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/vertex_mask.h"

namespace soapfilm {

/// A kind of link: from a vertex to the one `step` further, with the cost of cutting it.
struct Link {
  Vec3i step;
  double weight;
};
inline constexpr size_t max_links = 26;

/// One node. Bit d of `links` says whether neighbor[d] is in the graph.
struct BandVertex {
  uint32_t id = 0;
  Vec3i position;    ///< lattice coordinates
  double unary = 0;  ///< cost of u = 1: -f, and the links to fixed vertices, where u = 0
  uint32_t links = 0;
  std::array<uint32_t, max_links> neighbor;
};

class BandGraph {
 public:
  /// `band` may hold free vertices only. `links` has the opposite of direction d at size() - 1 - d; it and `support`
  /// must outlive the graph. Links to free vertices outside the band are left out.
  BandGraph(const VertexMask& band, const LevelBox& box, const SupportField& support, const std::vector<Link>& links,
            const Context& context);

  uint32_t vertices() const { return vertices_; }
  const std::vector<Link>& links() const { return links_; }
  size_t bytes() const { return grid_.bytes() + rows_.size() * sizeof(Row); }

  /// Visits the vertices in the order of their numbers.
  class Cursor {
   public:
    explicit Cursor(const BandGraph& graph) : graph_(graph) {}
    /// False after the last one.
    bool next(BandVertex& vertex);

   private:
    const BandGraph& graph_;
    size_t row_ = 0;     ///< the next one
    unsigned bits_ = 0;  ///< of the row before it, still to be visited
    uint32_t id_ = 0;
  };

 private:
  /// A brick's row: the bits of its vertices, and the number of vertices before it.
  struct Row {
    uint32_t before = 0;
    uint8_t bits = 0;
  };
  static constexpr size_t rows_per_brick = brick_area;

  void measure_surroundings(BandVertex& vertex, size_t brick, Vec3i local) const;

  const LevelBox box_;
  const SupportField& support_;
  const std::vector<Link>& links_;
  BrickGrid grid_;
  std::vector<Row> rows_;  ///< of brick b's row (y, z): 64 b + y + 8 z
  std::vector<int32_t> f_brick_;
  uint32_t vertices_ = 0;
};

}  // namespace soapfilm
