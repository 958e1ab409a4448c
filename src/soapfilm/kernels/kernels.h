// The parts of operations on whole levels (sweeps, energies, the data term, the fit): the work on one brick or row,
// once for each back end. A run's context holds those of its back end; back_ends.cpp has the table.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "soapfilm/kernels/divergence_kernel.h"
#include "soapfilm/kernels/energy_kernel.h"
#include "soapfilm/kernels/row_kernel.h"
#include "soapfilm/kernels/sor_kernel.h"
#include "soapfilm/kernels/sweep_kernel.h"

namespace soapfilm {

struct Kernels {
  std::array<SweepKernel, 2> sweeps;     ///< by norm
  std::array<EnergyKernel, 2> energies;  ///< by norm
  DivergenceKernel divergence;
  SorKernel sor;
  RowKernel rows;

  const SweepKernel& sweep(Norm norm) const { return sweeps[static_cast<size_t>(norm)]; }
  const EnergyKernel& energy(Norm norm) const { return energies[static_cast<size_t>(norm)]; }
};

/// A set of kernels for some processors. All give the same bits.
struct BackEnd {
  std::vector<std::string> (*targets)();          ///< that this machine can run, best first
  Kernels (*kernels)(const std::string& target);  ///< `target`: one of these
};

/// Highway's SIMD targets, and the scalar version.
BackEnd highway_back_end();
BackEnd scalar_back_end();

}  // namespace soapfilm
