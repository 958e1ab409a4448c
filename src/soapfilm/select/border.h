// What lies beyond the box of the samples: air, as around an object, solid matter, as around a room seen from inside,
// or neither, where the samples are a sheet that ends, such as terrain or a facade.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "soapfilm/core/parallel.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/pyramid/coarse_to_fine.h"

namespace soapfilm {

enum class Border : uint8_t {
  automatic,
  air,    ///< u = 0 beyond the box: a closed surface that looks outward
  solid,  ///< u = 1 there: a closed surface that looks inward; solved as its complement, all directions turned
  open    ///< the surface may end at the box, at no cost
};
/// As --outside and report.json call them, in the order of the enumeration.
inline constexpr std::array<const char*, 4> border_names = {"auto", "air", "solid", "open"};
inline const char* name_of(Border border) { return border_names[static_cast<size_t>(border)]; }

struct BorderParams {
  Border outside = Border::automatic;
  double open_gain = 0.05;  ///< automatic: open where that lowers the energy by more than this share, (0, 1]
};

struct BorderReport {
  Border chosen = Border::air;
  std::string reason;  ///< half a line
  int level = -1;      ///< of the pyramid, on which it was tried; -1: it was not
  /// Lowest energies there with air, solid and nothing beyond; those that were found.
  std::optional<double> air, solid, open;
  double border_flux = 0;  ///< with air: flux through the border over |E|; what another border can gain at most
};

void validate(const BorderParams& params);

/// f of the complement: minus f.
void negate(SupportField& field, const Parallel& parallel);

/// Which border the data asks for. Solves a coarse level with air beyond the box; its dual, whatever it sends through
/// the border set to 0, bounds the energy that any other border could reach. Where that leaves something to gain, a
/// level whose cells are four voxels is solved with each of the three.
BorderReport choose_border(const Lattice& lattice, const SupportField& field, double lambda, const BorderParams& params,
                           const PrimalDualParams& solver, Norm norm, const Parallel& parallel, Progress& progress);

}  // namespace soapfilm
