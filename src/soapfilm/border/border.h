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

/// What lies beyond the box, and why. Energies are those of a coarse level, costs of area lambda TV(u) there.
struct BorderReport {
  Border chosen = Border::air;
  std::string reason;  ///< half a line
  int level = -1;      ///< of the pyramid, on which it was tried; -1: it was not
  /// Lowest energies with air, solid and nothing beyond; those that were looked for.
  std::optional<double> air, solid, open;
  std::optional<double> open_bound;  ///< no open surface has a lower energy
  double area_cost = 0;              ///< of the better closed surface, at least 1000 lambda
  double closing = 0;                ///< share of that surface that is there only to close it, [0, 1]
  double border_flux = 0;            ///< with air: flux through the border over that surface's cost of area
  Surroundings scanners;
};

/// What is to be solved, on the finest level.
struct BorderProblem {
  const Lattice& lattice;
  SupportField& field;  ///< turned while solid matter is tried; comes back as it was
  double lambda;
  Norm norm;
  double density;  ///< samples per voxel^2 of surface
};

void validate(const BorderParams& params);

/// f of the complement: minus f.
void negate(SupportField& field, const Context& context);

/// Which border the data asks for. Solves a coarse level, whose cells are as wide as four voxels or the samples'
/// spacing, with air beyond the box; its dual, whatever it sends through the border set to 0, bounds the energy that
/// any other border could reach. Where that leaves something to gain the level is solved with solid matter beyond, and
/// open. The lower of the two closed energies wins, air where they are alike; unless an open surface
///   - spares more than params.open_gain of the closed one's cost of area, or
///   - could spare a twentieth, and the `scanners` stand among samples that leave a quarter of the directions around
///     them free, such as a street's: far samples are too sparse to tell by energies, or
///   - spares a twentieth, and more than two fifths of the closed one are there only to close it (closing_share()):
///   from
///     a small sheet that lies askew the way to the border costs much of what it spares.
BorderReport choose_border(const BorderProblem& problem, const Surroundings& scanners, const BorderParams& params,
                           PrimalDualParams solver, const Context& context);

}  // namespace soapfilm
