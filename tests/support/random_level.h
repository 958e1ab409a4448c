// Random levels that satisfy only the contract: random box, band, data, u and p.
#pragma once

#include <cmath>
#include <span>

#include "soapfilm/core/random.h"
#include "soapfilm/solve/level.h"
#include "support/dense.h"
#include "support/hash.h"
#include "support/sanitized.h"

namespace soapfilm::test {

/// A vector in the ball of the given radius.
inline Vec3f random_in_ball(Random& random, double radius) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return Vec3f(normalized(Vec3d{x, y, z}) * (radius * std::cbrt(random.uniform())));
}

/// Fluxes through the faces between the band and the inactive bricks.
enum class RimFlux { zero, random };

struct RandomLevelParams {
  double lambda = 0.1;
  double band = 0.5;     ///< share of the bricks that are active
  double support = 0.6;  ///< share of those that have data
  RimFlux rim = RimFlux::random;
  Norm norm = Norm::isotropic;
  double held = 0;                        ///< share of the active bricks that are held
  bool open = false;                      ///< of the box; p is 0 where that has no faces
  int more_layers = sanitized ? 40 : 90;  ///< along z, in addition to 36 to 51: enough bricks for several tiles of work
};

/// u is uniform in [0, 1] at free vertices, f normal on the support, p uniform in the ball of lambda. Outside the band
/// u = 0.
struct RandomLevel {
  BrickGrid support;
  Field<float> f;
  Level level;

  RandomLevel(const RandomLevel&) = delete;
  RandomLevel& operator=(const RandomLevel&) = delete;

  explicit RandomLevel(uint64_t seed, const RandomLevelParams& params = {}) {
    Random random(seed);
    const Context context(1);
    Lattice lattice;
    for (int axis = 0; axis < 3; ++axis) lattice.size[axis] = 36 + static_cast<int>(random.next() % 16);
    lattice.size.z += params.more_layers;
    lattice.open = params.open;
    const LevelBox box = lattice.box(0);

    BrickMask band(box.bricks), with_data(box.bricks);
    BrickMask::whole(box.bricks).for_each([&](Vec3i b) {
      if (random.uniform() >= params.band) return;
      band.set(b);
      if (random.uniform() < params.support) with_data.set(b);
    });
    support = BrickGrid(with_data, context);
    f = Field<float>(support);
    for (size_t b = 0; b < support.size(); ++b)
      for (int i = 0; i < brick_volume; ++i) f.brick(b)[i] = static_cast<float>(0.2 * random.normal());

    level = make_level(box, static_cast<float>(params.lambda), band, support, f, context, params.norm);
    for (size_t b = 0; b < level.grid.size(); ++b) fill_brick(random, b, params);
    if (params.held > 0)
      for (size_t b = 0; b < level.grid.size(); ++b)
        level.held.push_back(random.uniform() < params.held ? Held::rests : Held::no);
  }

 private:
  void fill_brick(Random& random, size_t b, const RandomLevelParams& params) {
    for_each_vertex(level.grid.coord(b), [&](Vec3i v, int i) {
      const auto value = static_cast<float>(random.uniform());
      level.u.brick(b)[i] = level.box.is_free(v) ? value : 0.0f;
      const Vec3f p = random_in_ball(random, params.lambda);
      for (int axis = 0; axis < 3; ++axis) {
        const bool face = !params.open || (level.box.is_free(v) && level.box.is_free(v + along(axis)));
        level.p.brick(b, axis)[i] = face ? p[axis] : 0;
      }
    });
    for (int axis = 0; axis < 3; ++axis) {
      if (float* plane = level.rim.plane(b, axis))
        for (int k = 0; k < brick_area; ++k) {
          const double flux = random.uniform(-params.lambda, params.lambda);
          plane[k] = params.rim == RimFlux::zero ? 0.0f : static_cast<float>(flux);
        }
      if (params.rim == RimFlux::zero && level.grid.neighbors(b)[static_cast<size_t>(slot_up[axis])] == outside_band)
        for (int i = 0; i < brick_volume; ++i)
          if (is_last(i, axis)) level.p.brick(b, axis)[i] = 0;
    }
  }

 public:
  /// Whether a brick's vertex is in the last layer along an axis.
  static bool is_last(int i, int axis) { return i / brick_stride[axis] % brick_side == brick_side - 1; }
};

/// Of u and p.
inline uint64_t hash_state(const Level& level) {
  uint64_t hash = 0;
  for (size_t b = 0; b < level.grid.size(); ++b) {
    hash = hash_bytes(std::span<const float>(level.u.brick(b), brick_volume), hash);
    hash = hash_bytes(std::span<const float>(level.p.brick(b), 3 * brick_volume), hash);
  }
  return hash;
}

}  // namespace soapfilm::test
