// The stages of a reconstruction, each with what belongs to it: its time, its lines, its part of the report.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "soapfilm/core/page_pool.h"
#include "soapfilm/core/stages.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/place.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/segment.h"

namespace soapfilm {

/// Runs the stages in the order of its functions; reconstruct.cpp says what each is for. Between any two of them, and
/// within each, the progress object may cancel. What a stage does is in the folder of its name (docs/architecture.md).
class Pipeline {
 public:
  /// Keeps references to all of them. Throws ParameterError.
  Pipeline(const ReconstructParams& params, const Context& context, const PyramidObserver& observe);

  /// Throws SamplesError or MemoryError.
  void check(const PointCloud& cloud);
  std::vector<Vec3f> orient(const PointCloud& cloud);
  GridSamples place(const PointCloud& cloud, std::span<const Vec3f> directions, AfterPlacing after);
  void weigh(const PointCloud& cloud, std::span<const Vec3f> directions, GridSamples& samples);

  /// Method::vrip: instead of all that follows.
  Mesh fuse(const PointCloud& cloud);

  SupportField field(const GridSamples& samples);
  /// Turns the data and the samples where solid matter lies beyond.
  void border(SupportField& field, GridSamples& samples);
  Segmentation solve(const SupportField& field, const GridSamples& samples);
  /// Throws EmptyResult. Frees the dual and the data term, which nobody reads afterwards. Closes an open solution along
  /// the box, for the stages up to finish_border().
  void certify(Level& level, SupportField& field);
  void drop_islands(Level& level, const GridSamples& samples);
  /// Where scanners stand in it.
  void place_scanners(const Level& level);
  /// From here on the samples' directions are as they were found, not those of planes.
  SurfaceField refine(Segmentation& found, GridSamples& samples);
  Mesh extract(const SurfaceField& surface);
  void bend(Mesh& mesh, const SurfaceField& surface, const GridSamples& samples);

  void finish_border(Mesh& mesh);
  void trim(Mesh& mesh, const GridSamples& samples);

  /// Every run says how much of the samples its mesh holds.
  void self_check(const Mesh& mesh, const GridSamples& samples);

  /// The vertices' distances, where they are asked for.
  void attribute(Mesh& mesh, const GridSamples& samples);

  /// Hands the mesh and the report out.
  Reconstruction finish(Mesh mesh);

 private:
  SurfaceField level_set(Segmentation& found, const GridSamples& samples);
  /// Once more is known of the plan, the refinement's part only `guessed` as yet. Throws MemoryError.
  void plan_again(bool guessed);
  /// Once the surface is known.
  void plan_mesh(const Level& level, bool checked);

  const ReconstructParams& params_;
  const Context& context_;
  const PyramidObserver& observe_;
  Stages stages_;
  ReconstructReport report_;
  Box3d box_;
  LocalSurface local_surface_;  ///< around each sample of the cloud; until weigh()
  std::vector<Vec3f> views_;    ///< directions before they were turned to planes, if any were; until refine()
  Surroundings scanners_;       ///< of what border() chooses by
  std::vector<Vec3d> scanner_positions_;
  std::optional<Room> room_;
  MemoryPlan plan_;                     ///< as far as it is known
  size_t first_plan_ = 0;               ///< bytes, before the solve
  std::optional<PagePool::Keep> keep_;  ///< from the solve to the mesh: each stage's arrays take the last one's place
};

}  // namespace soapfilm
