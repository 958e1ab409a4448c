// From the thresholded solve to a surface that lies on the samples: sub-voxel accuracy, the same topology.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "soapfilm/field/samples.h"
#include "soapfilm/refine/choose/fit_weights.h"
#include "soapfilm/refine/fit/robust_fit.h"
#include "soapfilm/refine/holes/hole_report.h"
#include "soapfilm/refine/topology/start.h"
#include "soapfilm/refine/topology/topology.h"
#include "soapfilm/report.h"
#include "soapfilm/solve/labels.h"
#include "soapfilm/surface/surface_field.h"

namespace soapfilm {

/// What users set, and what follows from other parameters or was fixed by measurement.
struct RefineSetup : RefineParams {
  RobustParams robust{};
  bool vanish = true;  ///< components and cavities of at most 64 vertices that the fit shrinks to their last one are
                       ///< removed: no surface fits their samples
  bool open = false;   ///< may the surface end at the border of the box? If so, holes do not bulge beyond it
  /// The bricks in which the surface moves; null: all. If not, the labels must hold those around them, and holes are
  /// flat.
  const BrickMask* where = nullptr;
  const BrickMask* flat_among = nullptr;  ///< holes stay flat if most bricks with samples around them are these
};

/// Throws ParameterError naming the first value that is out of its range, and the range.
void validate(const RefineSetup& params);

struct FitReport {
  FitWeights fit_weights;    ///< in use
  FitWeightReport search;    ///< how it was found
  HoleReport holes;          ///< where no sample covers the surface
  double spacing = 1;        ///< of the vertices that the fit worked on, voxels: 1, 2, 4, ...
  size_t band_vertices = 0;  ///< on either side of the surface
  size_t down_weighted = 0;  ///< samples of weight < 1/4, including those outside the band
  size_t flips = 0;          ///< vertices that changed their label
  size_t refused = 0;        ///< vertices that would have changed the topology and did not
  size_t vanished = 0;       ///< components and cavities that the fit shrank to their last vertex, which changed too
  int iterations = 0;        ///< conjugate-gradient steps on the whole band
};

/// Moves the surface between the labels onto the samples (design note in displacement.h). Its components and genus are
/// the labels', except for what has vanished: only simple points change their label, one after the other.
/// `density`: samples per voxel^2 of surface, 0 where it is not known. The result does not depend on the number of
/// threads.
class Refinement {
 public:
  /// Builds the band around the surface, its holes filled, and frees the labels that are moved in. Keeps references to
  /// the samples, the parameters, `context` and the report. Throws ParameterError.
  Refinement(Labels labels, const GridSamples& samples, double density, const RefineSetup& params,
             const Context& context, FitReport& report);

  /// Memory of the fit on a band of so many rows, where it may hold two grids at once: the peaks of bench/scenes within
  /// 10 %.
  static constexpr uint64_t bytes(uint64_t rows, bool tries_coarser, uint64_t samples) {
    return (tries_coarser ? 500 : 410) * rows + 48 * samples;
  }
  /// The same before the band is known, from the finest level: of closed surfaces 13,800 to 15,900 bytes per brick.
  static constexpr uint64_t bytes_of_level(uint64_t bricks) { return 15000 * bricks; }
  /// And before that level is, from the data's bricks (more in a scene): the narrow band and the fit's arrays; and
  /// cells with samples, of which a brick has about 32 where samples are dense. (What a fit on coarser vertices saves
  /// with sparse samples is known too late.)
  static constexpr uint64_t bytes_of_support(uint64_t bricks, bool scene, uint64_t samples) {
    return (scene ? 13500 : 11400) * bricks + 33 * std::min<uint64_t>(samples, 32 * bricks);
  }

  /// Rows of eight vertices that the fit works on: its memory is proportional to them.
  size_t rows() const { return start_.band.rows(); }
  /// Are samples so few that fits on coarser grids are tried?
  bool tries_coarser() const { return sparse_; }
  /// Call only once.
  DistanceField fit();

 private:
  void fill_holes(Labels& labels);

  const RefineSetup& params_;
  const Context& context_;
  const GridSamples& samples_;
  double density_;
  bool sparse_;
  FitReport& report_;
  Start start_;
  std::optional<SignBits> signs_;     ///< on the start's bricks
  Labels coarser_;                    ///< where sparse: of every second vertex
  std::optional<FitWeights> chosen_;  ///< if they were needed for holes
};

/// Both steps at once.
DistanceField refine(Labels labels, const GridSamples& samples, double density, const RefineSetup& params,
                     const Context& context, FitReport& report);

}  // namespace soapfilm
