// One level's convex problem on its band, and the state that the solver changes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/grid/field.h"
#include "soapfilm/grid/slabs.h"
#include "soapfilm/kernels/low_face.h"
#include "soapfilm/kernels/norm.h"
#include "soapfilm/solve/domain.h"

namespace soapfilm {

/// Where a brick's lower neighbor along an axis is inside the domain but not active, the flux through that face is
/// fixed: 64 values, the p_axis of the vertices on the far side. (The fluxes through upper faces to inactive bricks are
/// fixed too; they are stored in the band's own p.)
class Rim {
 public:
  static constexpr int32_t no_plane = -1;

  Rim() = default;
  explicit Rim(const BrickGrid& grid, const PagePool& pages = {});

  /// 64 fluxes, the lower of the two remaining coordinates fastest; null if the face is not on the band boundary.
  float* plane(size_t brick, int axis) {
    const int32_t k = plane_[brick][static_cast<size_t>(axis)];
    return k == no_plane ? nullptr : flux_.data() + static_cast<size_t>(k) * brick_area;
  }
  const float* plane(size_t brick, int axis) const { return const_cast<Rim*>(this)->plane(brick, axis); }
  AlignedArray<float>& flux() { return flux_; }  ///< all planes
  const AlignedArray<float>& flux() const { return flux_; }
  /// The planes of some bricks: those of neighboring bricks are neighbors.
  ItemRange planes(ItemRange bricks) const { return {planes_before(bricks.begin), planes_before(bricks.end)}; }

 private:
  size_t planes_before(size_t brick) const;

  std::vector<std::array<int32_t, 3>> plane_;
  AlignedArray<float> flux_;
};

/// Contribution to the energies of a part of the domain where u is constant, 0 or 1, and p is not changed.
struct OutsideTerms {
  double data = 0;  ///< to <f, u>
  double gain = 0;  ///< sum of max(0, f): minus what it adds to D(0)
  double dual = 0;  ///< to D(p)
  double gap = 0;   ///< to E(u) - D(p), >= 0

  OutsideTerms& operator+=(const OutsideTerms& o) {
    data += o.data;
    gain += o.gain;
    dual += o.dual;
    gap += o.gap;
    return *this;
  }
  /// Bounds for s p, s in [0, 1]: D is concave.
  double dual_of_scaled(double s) const { return s * dual - (1 - s) * gain; }
  double gap_of_scaled(double s) const { return s * gap + (1 - s) * (gain - data); }
};

/// Whether the iteration leaves a brick's u and p as they are: nothing changes them, and fluxes toward it are fixed; or
/// they follow those of another level's, and fluxes toward it move (adapt/solve_leaves.h).
enum class Held : uint8_t { no, rests, follows };

/// What a level minimizes: min lambda TV(u) - <f, u> over 0 <= u <= 1, u = 0 at fixed vertices (equation (4)),
/// restricted to a band of bricks. If the box is open TV is the sum over faces between free vertices only, so p = 0 on
/// all others; then the 0 of fixed vertices has no meaning, and "constant" for a brick that is partly fixed means
/// constant at its free vertices. Lattice units: h = 1 on every level.
///
/// Outside the band u is what the coarser level says: where that is constant (0 or 1) on a connected part, the part's
/// side, without a brick; elsewhere a brick of the grid that is held. In both p is the coarser level's too, and at the
/// band boundary it is the boundary flux.
struct LevelProblem : Domain {
  float lambda = 0;  ///< 4^level (area of a face in fine faces) times the finest level's, or a share of that
  Norm norm = Norm::isotropic;
  const Field<float>* f = nullptr;  ///< on the support bricks
  std::vector<int32_t> f_brick;     ///< index into f of each brick of the grid, -1: zero
  std::vector<Held> held;           ///< of each brick: whether it keeps its u and p; empty: none does

  /// 512 values of f.
  const float* data(size_t brick) const;
  bool is_held(int32_t brick) const { return !held.empty() && held[static_cast<size_t>(brick)] != Held::no; }
  /// Whether nothing changes the brick with this slot value (as BrickGrid::find gives it), though it is in the box.
  bool rests(int32_t slot) const {
    return slot == outside_band || (slot >= 0 && !held.empty() && held[static_cast<size_t>(slot)] == Held::rests);
  }
};

/// What the solver changes.
struct LevelState {
  Field<float> u;  ///< relaxed indicator, in [0, 1]
  Field<float, 3>
      p;  ///< dual: p_k of the face between a vertex and the next along axis k; |p| <= lambda by the norm's dual
  Rim rim;
  OutsideTerms outside;  ///< of the domain that has no bricks
  /// If not null a rank has u, p and rim of its slab and of the layers next to it alone. Those are as they were when
  /// ranks last exchanged them (solve/level_slabs.h): functions of a level take them to be up to date.
  std::shared_ptr<const Slabs> slabs;
};

struct Level : LevelProblem, LevelState {
  /// u of a brick that is not in the grid (slot value as BrickGrid::find gives it).
  float missing_u(int32_t slot, Vec3i brick) const { return is_inside(slot, brick) ? 1.0f : 0.0f; }
  /// u of a vertex, in the grid or not.
  float u_at(Vec3i vertex) const {
    const Vec3i brick = brick_of(vertex);
    const int32_t slot = grid.find(brick);
    return slot < 0 ? missing_u(slot, brick)
                    : u.brick(static_cast<size_t>(slot))[brick_offset(vertex.x & 7, vertex.y & 7, vertex.z & 7)];
  }
};

/// The memory of a level while it is solved: u and p, the layers that a sweep leaves behind, fluxes at the band
/// boundary (about one face in three), topology twice (band and support).
constexpr uint64_t level_bytes(uint64_t bricks) {
  constexpr uint64_t values = brick_volume * 4 * sizeof(float), layers = 3 * brick_area * sizeof(float);
  constexpr uint64_t rim = brick_area * sizeof(float), topology = sizeof(Vec3i) + sizeof(BrickGrid::Neighbors);
  return (values + layers + rim + 2 * topology + 128) * bricks;
}

/// A level whose u and p are zero and whose fluxes at the band boundary are zero.
Level make_level(const LevelBox& box, float lambda, const BrickMask& band, const BrickGrid& support,
                 const Field<float>& f, const Context& context, Norm norm = Norm::isotropic);

/// The bricks whose u and p this rank has: of a level without slabs all.
ItemRange bricks_at_hand(const Level& level);

/// p *= share on the band, its boundary and outside, 0 <= share <= 1: it stays feasible, and the certificate valid.
void scale_flux(Level& level, float share, const Context& context);

/// See kernels/low_face.h.
LowFace low_face(const Level& level, size_t brick, int axis);

}  // namespace soapfilm
