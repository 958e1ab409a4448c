// Detects when more iterations gain nothing: a minimal surface that the flux around a band cannot support keeps its gap
// for ever, and where samples are missing the relaxed gap may fall for thousands of iterations with no label changed.
#pragma once

#include <string_view>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/grid/brick_bits.h"
#include "soapfilm/report.h"
#include "soapfilm/solve/energy.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// Why a level ended.
enum class Stop : uint8_t {
  converged,  ///< the gap is within the tolerance
  settled,    ///< the thresholded u and its gap no longer change, and the dual cannot make that gap much smaller
  stalled,    ///< the gap no longer falls
  limit,      ///< the iterations ran out
  spent,      ///< a coarse level of an open surface has taken its share of the run's work
};

std::string_view name_of(Stop stop);

/// Detects that the gap no longer falls.
class Stall {
 public:
  /// Call after each computation of the gap, from all bricks (`whole`) or some. True if there was no new minimum in the
  /// last third of all iterations. A gap that falls as 1 / sqrt(iterations) or faster has new minima there.
  bool found(int iterations, double gap, bool whole);

 private:
  struct Look {
    int iterations;
    double lowest;  ///< smallest gap of that kind so far
  };
  std::vector<Look> looks_[2];
};

/// Detects that the thresholded u has settled.
class Settling {
 public:
  Settling(const Level& level, const Context& context) : level_(level), context_(context) {}

  /// Whether to compare the labels now: the relaxed gap is within ten times the tolerance.
  bool due(int iterations, double gap, double tolerance) const;
  /// `relaxed` is that of the level now. True if since the last comparison almost no label has changed, the thresholded
  /// gap has not fallen, and the relaxed gap is so small a fraction of it that no p could make it much smaller.
  bool found(int iterations, const Energies& relaxed);

 private:
  /// Stores the labels; returns how many differ from the last comparison.
  size_t changed_labels();

  const Level& level_;
  const Context& context_;
  int iterations_ = 0;  ///< at the last comparison, 0: none yet
  double gap_ = 0;      ///< thresholded
  std::vector<BrickBits> inside_;
};

}  // namespace soapfilm
