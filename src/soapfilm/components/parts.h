// The connected parts of the thresholded solution: of its inside and of its outside.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/grid/brick_bits.h"
#include "soapfilm/grid/gaps.h"
#include "soapfilm/solve/labels.h"

namespace soapfilm {

/// A connected part, and the surface between it and the part that surrounds it.
struct Part {
  bool inside = false;
  uint32_t around = 0;  ///< the part that surrounds it; the outermost part's is itself
  size_t vertices = 0;
  size_t faces = 0;  ///< pairs of neighboring vertices, one of them in `around`
};

/// The connected parts of the inside (6-connected) and of the outside (26-connected), as in the extracted surface
/// (docs/reference/topology.md). So the parts form a tree: each except the outermost lies in one other part of the
/// opposite side (Rosenfeld 1974). They are numbered in the order of their first bricks, whatever the number of
/// threads; part 0 is the outermost, which extends beyond the domain.
class Parts {
 public:
  Parts(const Labels& labels, const Context& context);

  size_t size() const { return parts_.size(); }
  const Part& operator[](uint32_t part) const { return parts_[part]; }

  /// Gives each part the side inside[part].
  void write(const std::vector<uint8_t>& inside, Labels& labels, const Context& context) const;

 private:
  friend class PartsAround;

  /// A connected part within one brick. Parts consist of pieces and of gaps.
  struct Piece {
    BrickBits vertices;
    bool inside;
  };
  struct Contact {
    uint32_t a, b;   ///< nodes
    uint32_t faces;  ///< 0: connected
  };

  // Nodes: 0 is everything beyond the domain, then the pieces, then the gaps.
  uint32_t node_of_piece(uint32_t piece) const { return 1 + piece; }
  uint32_t node_of_gap(size_t gap) const { return 1 + static_cast<uint32_t>(pieces_.size() + gap); }
  uint32_t node_of_missing(int32_t slot, Vec3i brick) const;

  void find_pieces(const Labels& labels, const Context& context);
  void touch_brick(const Labels& labels, size_t brick, std::vector<Contact>& contacts) const;
  void touch_gaps(std::vector<Contact>& contacts) const;
  void number_parts(const std::vector<Contact>& contacts);
  void find_surroundings(const std::vector<Contact>& contacts);

  const BrickGrid& grid_;
  LevelBox box_;
  std::vector<uint32_t> first_piece_;  ///< of each brick; one more at the end
  std::vector<Piece> pieces_;
  Gaps gaps_;
  GapSides side_;               ///< of each gap
  std::vector<uint32_t> part_;  ///< of each node
  std::vector<Part> parts_;
};

/// The parts of the vertices of a brick and of the 26 around it, looked up once for many vertices. Most bricks hold
/// only one or two parts: there a bit distinguishes them.
class PartsAround {
 public:
  PartsAround(const Parts& parts, Vec3i brick);

  /// The part that holds a vertex, given relative to the brick's first one, each coordinate in [-8, 16).
  uint32_t at(Vec3i vertex) const {
    const Vec3i offset = brick_of(vertex);
    const Holder& holder = holders_[static_cast<size_t>(neighbor_slot(offset.x, offset.y, offset.z))];
    const int x = vertex.x & 7, y = vertex.y & 7, z = vertex.z & 7;
    return holder.further ? further_part(holder, x, y, z) : holder.part[holder.first.test(x, y, z)];
  }

 private:
  struct Holder {
    BrickBits first;                 ///< vertices of the first piece; none where the brick is missing
    std::array<uint32_t, 2> part{};  ///< part outside the first piece, and its own
    uint32_t further = 0;            ///< the second piece of three or more; 0: no more than two
  };
  uint32_t further_part(const Holder& holder, int x, int y, int z) const;

  const Parts& parts_;
  std::array<Holder, 27> holders_;
};

}  // namespace soapfilm
