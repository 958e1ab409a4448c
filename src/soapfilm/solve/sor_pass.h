// Several SOR iterations in one pass over the box; the diffusivity between two renewals is kept for a few layers only.
//
// g is that of the u at the start of the pass, but no iteration needs more of it than three layers. So the stages of a
// pass (renew g, iterate, iterate, ...) follow one another through the layers at a distance, like a pipeline:
//
//   stage s works at step t on the layers [L (t - s) - s, L (t - s) - s + L),   L = 8 (red-black 4)
//
// Below it each stage finds the results of the previous stage, above it layers that the previous stage has not changed:
// the result equals running stage after stage over the whole box. The stages of one step have no layer in common, so
// they run in parallel. Memory: u and a ring of about 30 layers of g, about the paper's one float per vertex.
#pragma once

#include <vector>

#include "soapfilm/progress.h"
#include "soapfilm/solve/sor.h"
#include "soapfilm/solve/sor_runs.h"

namespace soapfilm {

class SorPass {
 public:
  /// `lambda` is this level's. The referenced arguments must outlive the pass.
  SorPass(DenseField<float>& u, double lambda, const SupportField& support, const SorParams& params,
          const Context& context);

  /// Renews g once, then iterates. Appends E(u) before each of the iterations to `energy`.
  void run(int iterations, std::vector<double>& energy);
  /// E(u) = lambda TV(u) - <f, u> of the current u.
  double energy();
  /// Memory of u, g, the kinds of runs and the data term.
  size_t bytes() const { return u_.bytes() + g_.bytes() + kinds_.bytes() + data_.bytes(); }

 private:
  struct Stage {
    enum class Kind { renew, measure, relax, relax_color } kind;
    int iteration;  ///< of the pass; E is measured before it
    int parity;     ///< of x + y + z (relax_color)
  };
  struct Task {
    const Stage* stage;
    int begin, end;  ///< layers
  };

  std::vector<Stage> stages(int iterations) const;
  void run_task(const Stage& stage, int begin, int end);
  void measure_layer(int z, int iteration, bool renew);
  /// Adds to the layer's sums; `renew` also stores g. `active` has room for a row's runs.
  void measure_row(int y, int z, int iteration, bool renew, std::vector<uint8_t>& active);
  SlopeJob slope_job(int y, int z);
  void relax_slab(int begin, int end, int iteration);
  void relax_color_layer(int z, int parity);
  /// The row's pointers; `f` has room for a row. Marks the runs that can change.
  SorRow relaxed_row(int y, int z, float* f, uint8_t* active);
  void clear_sums(int iterations);
  double sum_energy(int iteration) const;
  float* g_row(int y, int z);

  DenseField<float>& u_;
  const SorParams& params_;
  const Context& context_;
  const double lambda_;
  const SorKernel kernel_;
  RunKinds kinds_;
  DataRows data_;
  RelaxJob job_;
  float flat_g_;              ///< g where u is constant
  std::vector<float> zeros_;  ///< a row of them
  int slab_;                  ///< layers that a stage processes per step
  int ring_ = 0;              ///< layers of g
  AlignedArray<float> g_;
  std::vector<double> variation_, product_;  ///< per iteration of the pass and layer: sum of |grad u|, <f, u>
};

}  // namespace soapfilm
