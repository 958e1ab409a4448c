// Tells from when on more iterations buy nothing: a film that the flux around a band cannot carry keeps its gap for
// ever, and where samples are missing the relaxed gap may fall for thousands of iterations that no label hears of.
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
};

std::string_view name_of(Stop stop);

/// Finds that the gap no longer falls.
class Stall {
 public:
  /// After each look at the gap, of all bricks (`whole`) or of some: has it found no new low in a third of all
  /// iterations? A gap that falls as 1 / sqrt(iterations) or faster does.
  bool found(int iterations, double gap, bool whole);

 private:
  struct Look {
    int iterations;
    double lowest;  ///< gap of that kind so far
  };
  std::vector<Look> looks_[2];
};

/// Finds that the thresholded u has settled.
class Settling {
 public:
  Settling(const Level& level, const Context& context) : level_(level), context_(context) {}

  /// Is it time to look at the labels? The relaxed gap is within ten times the tolerance.
  bool due(int iterations, double gap, double tolerance) const;
  /// `relaxed` is of the level as it is. True when since the last look hardly a label has changed, the thresholded gap
  /// has not fallen, and the relaxed one is so small a part of it that no p could make it much smaller.
  bool found(int iterations, const Energies& relaxed);

 private:
  /// Remembers the labels; how many are not those of the last look.
  size_t changed_labels();

  const Level& level_;
  const Context& context_;
  int iterations_ = 0;  ///< at the last look, 0: there was none
  double gap_ = 0;      ///< thresholded
  std::vector<BrickBits> inside_;
};

}  // namespace soapfilm
