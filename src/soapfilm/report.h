// What a reconstruction tells about itself: report.json (docs/report.md).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "soapfilm/core/stages.h"
#include "soapfilm/finish/scanners.h"
#include "soapfilm/finish/self_check.h"
#include "soapfilm/fuse/vrip.h"
#include "soapfilm/lambda/cross_validation.h"
#include "soapfilm/mesh/distance.h"
#include "soapfilm/mesh/topology.h"
#include "soapfilm/params.h"
#include "soapfilm/pyramid/coarse_to_fine.h"
#include "soapfilm/solve/graph_cut.h"
#include "soapfilm/solve/poisson.h"
#include "soapfilm/solve/sor.h"

namespace soapfilm {

/// Energies and bounds on the finest grid, valid for the whole domain.
struct Certificate {
  double lambda = 0;
  Energies relaxed;   ///< of the relaxed u and of p
  Energies binary;    ///< of the thresholded u, the one that the mesh comes from, and the same p
  size_t inside = 0;  ///< thresholded vertices inside, whole domain

  double relative_gap() const { return relaxed.relative_gap(lambda); }
  double relative_gap_binary() const { return binary.relative_gap(lambda); }
  /// Relative to the area term: how much less area and misfit the optimum could have at most.
  double gap_per_area() const;
  double gap_per_area_binary() const;
};

struct InputFacts {
  size_t samples = 0;
  size_t dropped = 0;  ///< by the reader: not finite
  size_t scans = 0;
  Box3d box;
  double density = 0;  ///< samples per voxel^2 of surface
  OrientReport directions;
};

/// What the method tells of its work.
struct SolveReport {
  std::vector<LevelReport> levels;  ///< Method::tv; coarsest first
  std::vector<SorLevelReport> sor;  ///< Method::tv_sor; coarsest first
  std::optional<PoissonReport> poisson;
  std::optional<GraphCutReport> graph_cut;
};

/// Version of the layout of report.json; a new key keeps it, a changed meaning does not.
inline constexpr int report_version = 1;

struct ReconstructReport {
  std::string command;  ///< as typed; empty when called as a library
  ReconstructParams params;
  InputFacts input;
  Lattice lattice;
  std::optional<CrossValidationReport> select;  ///< when lambda was chosen by cross-validation
  BorderReport border;
  SolveReport solve;
  std::optional<VripReport> vrip;
  Certificate certificate;              ///< but for Method::vrip, which has no energy: lambda alone
  std::optional<IslandReport> islands;  ///< when parts that few samples support were dropped
  std::optional<RefineReport> refine;   ///< when the surface was moved onto the samples
  std::optional<BendReport> bend;       ///< when edges that bend were split
  std::optional<TrimReport> trim;       ///< when surface that no sample is near was looked for
  double isovalue = 0;                  ///< of the smoothed indicator; 0 of the refined field
  size_t mesh_vertices = 0;
  size_t mesh_triangles = 0;
  SelfCheckReport self_check;
  ScannerReport scanners;                          ///< not of Method::vrip
  std::optional<TopologyReport> topology;          ///< when it was checked
  std::optional<DistanceSummary> sample_distance;  ///< samples to mesh, input units
  std::vector<StageTime> stages;                   ///< in order
  size_t planned_bytes = 0;
  size_t peak_bytes = 0;   ///< of the process, which may do more than this run
  size_t array_bytes = 0;  ///< the most that this run's large arrays took at once: grids, bands, fields
  std::vector<std::string> warnings;
};

std::string to_json(const ReconstructReport& report);

}  // namespace soapfilm
