// What lies beyond the box of the samples: air, as around an object, solid matter, as around a room seen from inside,
// or neither, where the samples are a sheet that ends, such as terrain or a facade.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "soapfilm/border/surroundings.h"
#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/params.h"
#include "soapfilm/pyramid/coarse_to_fine.h"
#include "soapfilm/report.h"

namespace soapfilm {

/// What lies beyond the box, and why. Energies and costs of area (lambda TV(u)) are those of a coarse level.
struct BorderReport {
  Border chosen = Border::air;
  bool ends = false;    ///< the surface ends where it was not seen: with Border::open, or as most of it only closes it
  std::string reason;   ///< half a line of text
  bool turned = false;  ///< solid matter fitted, but the normals are those of a body, reversed: all are turned over
  int level = -1;       ///< of the pyramid, on which borders were compared; -1: none were
  /// Lowest energies with air, solid and nothing beyond, as far as they were computed.
  std::optional<double> air, solid, open;
  std::optional<double> open_bound;  ///< no open surface has a lower energy
  double area_cost = 0;              ///< of the better closed surface, at least 1000 lambda
  double closing = 0;                ///< share of that surface that is there only to close it, [0, 1]
  double border_flux = 0;            ///< with air: flux through the border over that surface's cost of area
  Surroundings scanners;
};

/// The problem, on the finest level.
struct BorderProblem {
  const Lattice& lattice;
  SupportField& field;  ///< negated while solid matter is tried; restored at the end
  double lambda;
  Norm norm;
  double density;        ///< samples per voxel^2 of surface
  double default_voxel;  ///< that the samples would have by default, input units
};

void validate(const BorderParams& params);

/// f of the complement: minus f.
void negate(SupportField& field, const Context& context);

/// Which border fits the data. Solves a coarse level, whose cells are as wide as four voxels or the samples' spacing,
/// with air beyond the box; its dual, with the flux through the border set to 0, bounds the energy of any other border.
/// Where that leaves a possible gain the level is solved with solid matter beyond, and open. The lower of the two
/// closed energies wins, air where they are alike; unless an open surface
///   - saves more than params.open_gain of the closed one's cost of area, or
///   - could save a twentieth, and the `scanners` stand among samples that leave a quarter of the directions around
///     them free, as in a street: far samples are too sparse to decide by energies, or
///   - saves a twentieth, and more than two fifths of the closed one are there only to close it (closing_share()):
///     for a small sheet at an angle to the box, the way to the border costs much of what it saves.
BorderReport choose_border(const BorderProblem& problem, const Surroundings& scanners, const BorderParams& params,
                           PrimalDualParams solver, const Context& context);

}  // namespace soapfilm
