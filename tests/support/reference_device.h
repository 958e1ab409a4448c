// A device that cannot be simpler: loops over all vertices of the box. Others must give its bits.
#pragma once

#include <memory>

#include "soapfilm/device/device.h"
#include "support/reference_band_solver.h"
#include "support/reference_level_solver.h"
#include "support/reference_levels.h"

namespace soapfilm::test {

class ReferenceDevice final : public Device {
 public:
  bool divergence(const GridSamples& samples, SupportField& field, const Context&) const override {
    reference_divergence(samples, field);
    return true;
  }
  bool restrict_data(const SupportField& fine, SupportField& coarse, const Context&) const override {
    reference_restriction(fine, coarse);
    return true;
  }
  std::shared_ptr<LevelSolver> on(Level& level, const Context& context) const override {
    return std::make_shared<ReferenceSolver>(level, context);
  }
  bool prolong_state(const Level& coarse, const Level* previous, Level& fine, const Context&) const override {
    ReferenceProlongation(coarse).onto(fine, previous);
    return true;
  }
  std::shared_ptr<BandSolver> on(const NarrowBand& band, const RowArray& phi0, const Context& context) const override {
    return std::make_shared<ReferenceBandSolver>(band, phi0, context);
  }
};

}  // namespace soapfilm::test
