#include "soapfilm/components/parts.h"

#include <algorithm>
#include <map>
#include <utility>

#include "soapfilm/core/gather.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/share.h"

namespace soapfilm {

namespace {

constexpr size_t grain = 64;
constexpr uint32_t none = ~uint32_t{0};

BrickBits with_six_neighbors(const BrickBits& bits) {
  BrickBits out = bits;
  for (int axis = 0; axis < 3; ++axis) out |= moved(bits, axis, 1) | moved(bits, axis, -1);
  return out;
}

/// The vertices of the brick at `offset` (each coordinate in -1..1) that are among the 26 neighbors of `bits`; with
/// offset 0 the bits too.
BrickBits neighbors_in(BrickBits bits, Vec3i offset) {
  for (int axis = 0; axis < 3; ++axis)
    bits = offset[axis] != 0 ? carried(bits, axis, offset[axis]) : bits | moved(bits, axis, 1) | moved(bits, axis, -1);
  return bits;
}

/// All of `allowed` that is connected to its first vertex.
BrickBits first_piece(const BrickBits& allowed, bool inside) {
  if (allowed == BrickBits::full()) return allowed;
  for (BrickBits reached = allowed.first();;) {
    const BrickBits next = (inside ? with_six_neighbors(reached) : neighbors_in(reached, {0, 0, 0})) & allowed;
    if (next == reached) return reached;
    reached = next;
  }
}

/// How many pairs of a vertex of `a` and one of `b`, in the brick at `offset`, share a face.
uint32_t shared_faces(const BrickBits& a, Vec3i offset, const BrickBits& b) {
  size_t faces = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (offset == Vec3i{0, 0, 0})
      faces += (moved(a, axis, 1) & b).count() + (moved(a, axis, -1) & b).count();
    else if (offset[axis] != 0)
      faces += (carried(a, axis, offset[axis]) & b).count();
  }
  return static_cast<uint32_t>(faces);
}

bool is_face(Vec3i offset) { return offset.x * offset.x + offset.y * offset.y + offset.z * offset.z == 1; }

uint32_t root_of(std::vector<uint32_t>& parent, uint32_t node) {
  while (parent[node] != node) node = parent[node] = parent[parent[node]];
  return node;
}

}  // namespace

Parts::Parts(const Labels& labels, const Context& context)
    : grid_(labels.grid), box_(labels.box), gaps_(grid_), side_(labels.inside) {
  find_pieces(labels, context);
  std::vector<Contact> contacts = share_gather<Contact>(
      grid_.size(), grain, context, [&](size_t b, std::vector<Contact>& found) { touch_brick(labels, b, found); });
  touch_gaps(contacts);
  number_parts(contacts);
  find_surroundings(contacts);
}

void Parts::find_pieces(const Labels& labels, const Context& context) {
  first_piece_.assign(grid_.size() + 1, 0);
  pieces_ = gather<Piece>(grid_.size(), grain, context, [&](size_t b, std::vector<Piece>& pieces) {
    const BrickBits& inside = labels.bits[b];
    const size_t before = pieces.size();
    for (const bool side : {true, false})
      for (BrickBits left = side ? inside : ~inside; left.any();) {
        pieces.push_back({first_piece(left, side), side});
        left &= ~pieces.back().vertices;
      }
    first_piece_[b + 1] = static_cast<uint32_t>(pieces.size() - before);
  });
  for (size_t b = 0; b < grid_.size(); ++b) first_piece_[b + 1] += first_piece_[b];
}

/// In an open box bricks without free vertices count as beyond the domain.
uint32_t Parts::node_of_missing(int32_t slot, Vec3i brick) const {
  if (slot == outside_box || (box_.open && !has_free(box_, brick))) return 0;
  return node_of_gap(grid_.gap(brick));
}

void Parts::touch_brick(const Labels& labels, size_t brick, std::vector<Contact>& contacts) const {
  const Vec3i coord = grid_.coord(brick);
  const auto touch = [&](uint32_t a, Vec3i offset, const BrickBits& other, bool other_inside, uint32_t node) {
    const Piece& piece = pieces_[a];
    if (piece.inside != other_inside) {
      if (offset != Vec3i{0, 0, 0} && !is_face(offset)) return;
      if (const uint32_t faces = shared_faces(piece.vertices, offset, other); faces > 0)
        contacts.push_back({node_of_piece(a), node, faces});
    } else if (piece.inside ? is_face(offset) && shared_faces(piece.vertices, offset, other) > 0
                            : (neighbors_in(piece.vertices, offset) & other).any()) {
      contacts.push_back({node_of_piece(a), node, 0});
    }
  };
  for (uint32_t a = first_piece_[brick]; a < first_piece_[brick + 1]; ++a) {
    for (int slot = 0; slot < 27; ++slot) {
      const Vec3i offset = slot_offset(slot);
      const int32_t n = grid_.neighbors(brick)[static_cast<size_t>(slot)];
      if (n < 0) {
        touch(a, offset, BrickBits::full(), labels.is_inside(n, coord + offset), node_of_missing(n, coord + offset));
        continue;
      }
      // Each pair of bricks, or of pieces of one, is visited once.
      const auto other = static_cast<size_t>(n);
      if (other > brick) continue;
      const uint32_t end = other == brick ? a : first_piece_[other + 1];
      for (uint32_t b = first_piece_[other]; b < end; ++b)
        touch(a, offset, pieces_[b].vertices, pieces_[b].inside, node_of_piece(b));
    }
  }
}

/// Gaps touch each other and the end of the domain. (If two of different sides touched, the surface between them would
/// not be drawn: extract/isosurface.h.)
void Parts::touch_gaps(std::vector<Contact>& contacts) const {
  gaps_.for_each_contact([&](size_t a, size_t b) {
    if (side_[a] == side_[b] && (!side_[a] || shared_faces(gaps_[a], gaps_[b]) > 0))
      contacts.push_back({node_of_gap(a), node_of_gap(b), 0});
  });
  const BrickRange box = BrickRange::whole(grid_.bricks());
  for (size_t g = 0; g < gaps_.size(); ++g)
    if (!side_[g] && faces_at_end(gaps_[g], box) > 0) contacts.push_back({0, node_of_gap(g), 0});
}

void Parts::number_parts(const std::vector<Contact>& contacts) {
  std::vector<uint32_t> parent(1 + pieces_.size() + gaps_.size());
  for (uint32_t node = 0; node < parent.size(); ++node) parent[node] = node;
  for (const Contact& c : contacts) {
    if (c.faces > 0) continue;
    const uint32_t a = root_of(parent, c.a), b = root_of(parent, c.b);
    parent[std::max(a, b)] = std::min(a, b);
  }
  // The root is the smallest node, so a part's number is known when its first node is met.
  part_.assign(parent.size(), none);
  const auto put = [&](uint32_t node, bool inside, size_t vertices) {
    const uint32_t root = root_of(parent, node);
    if (part_[root] == none) {
      part_[root] = static_cast<uint32_t>(parts_.size());
      parts_.push_back({inside, 0, 0, 0});
    }
    part_[node] = part_[root];
    parts_[part_[node]].vertices += vertices;
  };
  put(0, false, 0);
  for (uint32_t k = 0; k < pieces_.size(); ++k) put(node_of_piece(k), pieces_[k].inside, pieces_[k].vertices.count());
  for (size_t g = 0; g < gaps_.size(); ++g)
    if (!gaps_[g].empty()) put(node_of_gap(g), side_[g], count_vertices(gaps_[g]));
}

void Parts::find_surroundings(const std::vector<Contact>& contacts) {
  std::map<std::pair<uint32_t, uint32_t>, size_t> faces;
  for (const Contact& c : contacts)
    if (c.faces > 0) faces[std::minmax(part_[c.a], part_[c.b])] += c.faces;
  std::vector<std::vector<std::pair<uint32_t, size_t>>> neighbors(parts_.size());
  for (const auto& [pair, count] : faces) {
    neighbors[pair.first].emplace_back(pair.second, count);
    neighbors[pair.second].emplace_back(pair.first, count);
  }
  // From the outermost part inwards.
  std::vector<uint32_t> front{0};
  while (!front.empty()) {
    const uint32_t around = front.back();
    front.pop_back();
    for (const auto& [part, count] : neighbors[around]) {
      if (part == parts_[around].around) continue;
      parts_[part].around = around;
      parts_[part].faces = count;
      front.push_back(part);
    }
  }
}

PartsAround::PartsAround(const Parts& parts, Vec3i brick) : parts_(parts) {
  for (int slot = 0; slot < 27; ++slot) {
    const Vec3i at = brick + slot_offset(slot);
    const int32_t found = parts.grid_.find(at);
    Holder& holder = holders_[static_cast<size_t>(slot)];
    if (found < 0) {
      holder.part.fill(parts.part_[parts.node_of_missing(found, at)]);
      continue;
    }
    const uint32_t first = parts.first_piece_[static_cast<size_t>(found)];
    const uint32_t last = parts.first_piece_[static_cast<size_t>(found) + 1] - 1;
    holder.first = parts.pieces_[first].vertices;
    holder.part = {parts.part_[parts.node_of_piece(last)], parts.part_[parts.node_of_piece(first)]};
    holder.further = last > first + 1 ? first + 1 : 0;
  }
}

uint32_t PartsAround::further_part(const Holder& holder, int x, int y, int z) const {
  if (holder.first.test(x, y, z)) return holder.part[1];
  uint32_t piece = holder.further;
  while (!parts_.pieces_[piece].vertices.test(x, y, z)) ++piece;
  return parts_.part_[parts_.node_of_piece(piece)];
}

void Parts::write(const std::vector<uint8_t>& inside, Labels& labels, const Context& context) const {
  const auto flipped = [&](uint32_t node) { return parts_[part_[node]].inside != (inside[part_[node]] != 0); };
  parallel_for(context, grid_.size(), grain, [&](size_t b) {
    for (uint32_t k = first_piece_[b]; k < first_piece_[b + 1]; ++k)
      if (flipped(node_of_piece(k))) labels.bits[b] = labels.bits[b] ^ pieces_[k].vertices;
  });
  for (size_t g = 0; g < gaps_.size(); ++g)
    if (!gaps_[g].empty() && flipped(node_of_gap(g))) labels.inside.set(g, !side_[g]);
}

}  // namespace soapfilm
