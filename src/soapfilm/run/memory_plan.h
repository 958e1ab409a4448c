// The memory of a run, known before it starts. Counted in 64 bits: in a browser a size_t has 32, and what would not fit
// must not wrap round.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>

#include "soapfilm/cloud.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/params.h"
#include "soapfilm/pyramid/coarse_to_fine.h"
#include "soapfilm/run/scratch_plan.h"
#include "soapfilm/solve/labels.h"

namespace soapfilm {

/// The program itself with its libraries, threads and file buffers.
inline constexpr uint64_t program_bytes = uint64_t{12} << 20;

/// Bytes that a stage will need. A run is refused only if the certain share of a guess does not fit; the rest may be an
/// overestimate.
struct Planned {
  uint64_t bytes = 0;
  double certain = 1;
  uint64_t least() const { return static_cast<uint64_t>(certain * static_cast<double>(bytes)); }
};

/// Each stage's part is planned again once its size is known, and replaces the guess.
struct MemoryPlan {
  uint64_t fixed_bytes = 0;    ///< in all stages after placing: the program and the data kept of the samples
  Planned solve;               ///< in addition: the finest level's band and the coarser one, the box's tables
  uint64_t tables_bytes = 0;   ///< those of the solve that span the box
  Planned refine;              ///< in addition to fixed_bytes
  Planned mesh;                ///< in addition to fixed_bytes; before the surface is known only if that needs much
  Planned gap;                 ///< of each vertex of the band, from the solve's end to the mesh
  uint64_t kept_bytes = 0;     ///< of solved levels, from the solve's end until they are solved as one
  uint64_t joint_bytes = 0;    ///< what that needs, with them
  uint64_t placing_bytes = 0;  ///< the peak before: the cloud, its directions, the samples sorted by brick; and the
                               ///< surface found around them
  uint64_t grid_bytes() const { return std::max({solve.bytes, refine.bytes, joint_bytes, mesh.bytes}) + gap.bytes; }
  uint64_t total() const { return std::max(placing_bytes, fixed_bytes + grid_bytes()); }
  /// The part of it that is certain.
  uint64_t least() const {
    const uint64_t grid = std::max({solve.least(), refine.least(), joint_bytes, mesh.least()});
    return std::max(placing_bytes, fixed_bytes + grid + gap.least());
  }
};

/// What happens to the cloud once its samples are on the grid.
enum class AfterPlacing { kept, freed };

/// An object, or what surrounds its scanners or was seen from above: such a scene has wide gaps and distant parts, and
/// more of the grid is needed around its samples.
enum class Kind { object, scene };

/// The bricks that the samples reach, the only part of the grid that is known before the solve, and what of.
struct Support {
  uint64_t bricks = 0;
  Kind kind = Kind::object;
};

/// The needs of a reconstruction on this lattice; the band's size follows from the support. The mesh is not planned
/// yet, unless it will be checked or simplified.
MemoryPlan plan_memory(const ReconstructParams& params, const PointCloud& cloud, AfterPlacing after,
                       const Lattice& lattice, const Support& support);

/// The same before anything is built: arrays over the whole box, whatever the samples.
MemoryPlan plan_tables(Method method, const Lattice& lattice);

/// What is kept during the solve, whatever the grid: MemoryPlan::fixed_bytes.
uint64_t plan_fixed(Method method, const PointCloud& cloud, AfterPlacing after);

/// What placing the samples needs, whatever the grid: MemoryPlan::placing_bytes.
uint64_t plan_placing(const PointCloud& cloud);

/// The mesh and its relaxation or, if they are more, its simplification or the needs of check_result().
uint64_t mesh_bytes(uint64_t vertices, const ReconstructParams& params);

/// The memory that a run may use: `limit` or, without one, the machine's free memory plus what this process `held` when
/// the run began, which the plans count too. `what` names it in messages.
struct Room {
  Room(std::optional<uint64_t> limit, uint64_t held);
  uint64_t bytes;
  const char* what;
};

/// Throws MemoryError when the certain part of the plan exceeds the room. The message names the voxel that would fit
/// all of it, or the resolution where the grid was given `by_resolution`: tables of the box grow with the cube of the
/// resolution, a surface of `area`, voxel^2, with its square.
void check_memory(const MemoryPlan& plan, const Room& room, const Lattice& lattice, double area, bool by_resolution);

/// The same for plan_placing().
void check_placing(uint64_t placing_bytes, const Room& room, uint64_t samples);

/// The smallest voxel, two digits, that would fit into the context's limit or the free memory, where the samples'
/// surface has an area of about `area`, input units^2; 0: none. For a first choice: the run plans again, as it comes to
/// know its grid.
double smallest_voxel(const PointCloud& cloud, double area, const ReconstructParams& params, const Context& context);

/// The plan of one run: made part by part, as the sizes of its stages become known; refuses a run that would not fit,
/// or moves its large arrays to the context's scratch folder.
class MemoryBudget {
 public:
  /// Keeps a reference to the parameters. Throws MemoryError where the samples alone, on any grid, need more.
  MemoryBudget(const ReconstructParams& params, const PointCloud& cloud, AfterPlacing after, const Context& context);

  /// Call once the grid is known, before anything is built on it: plans the arrays that span its box. `area` is the
  /// surface's, voxel^2. This and the following throw MemoryError.
  void plan_tables(const PointCloud& cloud, const Box3d& box, const Lattice& lattice, double area);
  /// Call once its samples are on it: plans with the bricks that they reach.
  void plan_grid(const PointCloud& cloud, const Support& support);
  /// `user`, which also plans each level or graph of the solve as it begins; `data_bricks` are the data term's.
  PyramidObserver watch(PyramidObserver user, uint64_t data_bricks);
  /// Plans so much in addition to the solve and to what is kept, while its finest level is there; the largest of
  /// several calls counts. Returns false, and plans nothing, where it does not fit.
  bool plan_beside(uint64_t bytes);
  /// Plans that so much of the solved levels is kept until they are solved as one, with so much in addition. Returns
  /// false, and plans nothing, where it does not fit.
  bool plan_kept(uint64_t bytes, uint64_t beside = 0);
  /// What limits the memory, for messages.
  const char* room() const { return room_.what; }
  /// Call once the surface is known. `checked`: check_result() will follow on this mesh. `faced_samples`:
  /// those that trimming asks on which side they look.
  void plan_mesh(const Labels& labels, uint64_t faced_samples, const Context& context);
  /// Call once the refinement's band is known.
  void plan_refinement(uint64_t rows, bool tries_coarser, uint64_t samples);

  const MemoryPlan& plan() const { return plan_; }
  /// Takes the plan of an earlier run, up to the same stage.
  void take(const MemoryPlan& plan);

  /// In memory; and on disk.
  uint64_t planned_bytes() const { return scratch_.used() ? scratch_.resident_part(plan_).total() : plan_.total(); }
  uint64_t planned_disk_bytes() const { return scratch_.used() ? scratch_.disk_part(plan_).total() : 0; }
  /// Both, for messages.
  std::string summary() const;
  /// As planned before the solve.
  uint64_t first_bytes() const { return first_; }

 private:
  void plan_cut(uint64_t vertices, uint64_t data_bricks);
  void plan_level(int level, uint64_t data_bricks, uint64_t bricks, uint64_t beside);
  void check();

  const ReconstructParams& params_;
  AfterPlacing after_;
  Room room_;
  ScratchBudget scratch_;
  Lattice lattice_;
  double area_ = 0;  ///< of the surface, voxel^2
  MemoryPlan plan_;
  uint64_t solve_alone_ = 0;  ///< of plan_.solve, without plan_beside()
  uint64_t first_ = 0;
  bool solved_ = false;
};

}  // namespace soapfilm
