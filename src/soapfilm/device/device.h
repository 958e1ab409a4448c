// Where the work on whole levels and whole bands is done. The context carries the choice: on_device() in
// core/context_state.h; by default, and in all that a device leaves to it, it is the CPU.
//
// A device gives the CPU's bits: each operation says in its own folder which sums it takes, in which order. Nothing is
// contracted, square root and division are correctly rounded. Which bricks there are, and when to stop, is decided on
// the host.
#pragma once

#include <memory>

#include "soapfilm/context.h"

namespace soapfilm {

template <class T>
class AlignedArray;
class BandSolver;
struct GridSamples;
struct Level;
class LevelSolver;
class NarrowBand;
struct SupportField;

/// Its functions return null, or false, for what the device leaves to the CPU. All arguments outlive what is returned.
/// Has no state that a run changes: runs on several threads may share it.
class Device {
 public:
  virtual ~Device() = default;

  /// field/divergence.h: f of `field`, zero so far on the bricks that the samples reach.
  virtual bool divergence(const GridSamples& samples, SupportField& field, const Context& context) const;
  /// pyramid/restrict.h: f of `coarse`, zero so far on the parents of the fine field's bricks.
  virtual bool restrict_data(const SupportField& fine, SupportField& coarse, const Context& context) const;
  /// solve/level_solver.h: the iteration, and the energies of what it reaches. Takes u, p and the data from the level.
  virtual std::shared_ptr<LevelSolver> on(Level& level, const Context& context) const;
  /// pyramid/prolong.h: u, p and the rim's fluxes of `fine`, but u and p of bricks that `previous` has: there they are
  /// its own. `previous` may be null.
  virtual bool prolong_state(const Level& coarse, const Level* previous, Level& fine, const Context& context) const;
  /// refine/fit/band_solver.h: the system of the fit to the samples.
  virtual std::shared_ptr<BandSolver> on(const NarrowBand& band, const AlignedArray<float>& phi0,
                                         const Context& context) const;
};

}  // namespace soapfilm
