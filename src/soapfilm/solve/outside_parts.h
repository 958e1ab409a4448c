// The connected parts of a level's box outside a band of vertices.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/grid/vertex_mask.h"
#include "soapfilm/solve/band_graph.h"

namespace soapfilm {

/// The labels of the parts after a cut: a part has one label if all band vertices linked to it have the same.
struct RimVotes {
  VertexMask inside;   ///< band vertices with u = 1 linked to a part whose boundary disagrees
  VertexMask outside;  ///< the same with u = 0, or those at the border if only that has u = 0
  bool agree = true;
};

/// The vertices outside the band, fixed ones included, as runs along x; runs joined by a link are one part. The part of
/// the fixed vertices must have u = 0.
class OutsideParts {
 public:
  OutsideParts(const VertexMask& band, const LevelBox& box, const std::vector<Link>& links);

  RimVotes vote(const VertexMask& inside);
  /// Sets the vertices of the parts whose boundary has u = 1. Only after a vote in which all boundaries agreed.
  void fill(VertexMask& inside) const;

 private:
  struct Run {
    int32_t first, last;
    uint32_t parent;
  };
  struct Count {
    size_t inside = 0, outside = 0;
    bool agree() const { return inside == 0 || outside == 0; }
  };

  size_t row_of(int y, int z) const;
  uint32_t root(uint32_t run);
  uint32_t part_at(Vec3i v);
  void join_rows(size_t row, size_t other, int reach);
  /// Calls visit(band vertex, part) for every link between the band and a free vertex outside it.
  template <class Visit>
  void for_each_rim_link(Visit&& visit);

  const VertexMask& band_;
  const LevelBox box_;
  const std::vector<Link>& links_;
  Vec3i lo_, size_;                  ///< of the free vertices and one layer of fixed ones
  std::vector<uint32_t> row_begin_;  ///< first run of each row; one more at the end
  std::vector<Run> runs_;
  std::vector<Count> count_;  ///< per run, used at roots
};

}  // namespace soapfilm
