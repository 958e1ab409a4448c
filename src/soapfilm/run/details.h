// The contents of report.json beyond include/soapfilm/report.h.
#pragma once

#include <optional>
#include <vector>

#include "soapfilm/border/border.h"
#include "soapfilm/fuse/vrip.h"
#include "soapfilm/lambda/cross_validation.h"
#include "soapfilm/pyramid/coarse_to_fine.h"
#include "soapfilm/refine/refine.h"
#include "soapfilm/run/rank_times.h"
#include "soapfilm/solve/graph_cut.h"
#include "soapfilm/solve/poisson.h"
#include "soapfilm/solve/sor.h"
#include "soapfilm/solve/volume_interval.h"

namespace soapfilm {

/// The method's report of its work.
struct SolveReport {
  std::vector<LevelReport> levels;  ///< Method::tv; coarsest first
  std::vector<SorLevelReport> sor;  ///< Method::tv_sor; coarsest first
  std::optional<PoissonReport> poisson;
  std::optional<GraphCutReport> graph_cut;
  std::optional<GraphCutReport> leaf_cut;  ///< of the leaves of all levels, where levels adapt and there are several
};

struct ReportDetails {
  std::optional<CrossValidationReport> select;  ///< when lambda was chosen by cross-validation
  SolveReport solve;
  std::optional<VripReport> vrip;
  BorderReport border;
  std::optional<VolumeInterval> volumes;  ///< when asked for
  std::optional<FitReport> refine;        ///< when the surface was moved onto the samples
  std::vector<size_t> leaves;             ///< where levels adapt and there are several: of each, the finest first
  double leaf_voxel = 0;                  ///< of these, input units; 0: there are none
  std::optional<Certificate> of_grid;     ///< of the grid's level alone, where the report's is of several levels
  std::vector<RankTimes> ranks;           ///< of a run on several processes
  double gap_at_borders = 0;              ///< of the certificate's gap, where levels meet
};

}  // namespace soapfilm
