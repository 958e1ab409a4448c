// Graph cuts and problems small enough to try every labeling.
#pragma once

#include <algorithm>

#include "soapfilm/solve/graph_cut.h"
#include "support/dense.h"
#include "support/problem.h"

namespace soapfilm::test {

struct Cut {
  GraphCutReport report;
  Level level;
};

inline Cut cut(const Problem& problem, double lambda, const GraphCutSetup& params, int threads = 1) {
  Cut result;
  result.level = solve_graph_cut(problem.lattice, problem.support, lambda, params, Context(threads), result.report);
  return result;
}

/// Normal deviates at some vertices of a tiny lattice's bricks, fixed ones included.
inline Problem tiny_problem(Vec3i free, uint64_t seed) {
  Problem problem;
  problem.lattice.size = free + Vec3i{2, 2, 2};
  const LevelBox box = problem.lattice.box(0);
  problem.support.grid = BrickGrid(BrickMask::whole(box.bricks), Context(1));
  problem.support.f = Field<float>(problem.support.grid);
  Random random(seed);
  for (size_t b = 0; b < problem.support.grid.size(); ++b)
    for_each_vertex(problem.support.grid.coord(b), [&](Vec3i, int i) {
      const double value = random.normal();
      problem.support.f.brick(b)[i] = random.uniform() < 0.6 ? static_cast<float>(value) : 0.0f;
    });
  return problem;
}

}  // namespace soapfilm::test
