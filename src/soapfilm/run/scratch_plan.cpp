#include "soapfilm/run/scratch_plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/error.h"
#include "soapfilm/platform/scratch.h"
#include "soapfilm/run/defaults.h"
#include "soapfilm/run/memory_plan.h"

namespace soapfilm {

namespace {

/// Shares of a plan's parts that stay in memory; of placing and of the samples beside the program itself.
struct ResidentShares {
  double placing, fixed, solve, refine, mesh, gap;
};

/// Arrays that are too small for a file, in each stage: measured 12 MiB together with their shares.
constexpr uint64_t small_arrays = uint64_t{12} << 20;

/// Of the check's trees, which belong to another library: of a part of the mesh, and this much where it is small.
constexpr uint64_t least_tree = uint64_t{18} << 20;

/// The library's arrays are values on the bricks and rows of grids; their topology, samples and meshes are vectors.
/// Relaxing has the smoothed field beside the mesh.
ResidentShares shares_of(const ReconstructParams& params, bool moves_vectors) {
  if (moves_vectors) return {0.05, 0.05, 0.05, 0.05, params.checked ? 0.07 : 0.05, 0.05};
  const double solve = is_graph_cut(params.method) ? 1 : params.method == Method::poisson ? 0.12 : 0.05;
  const double mesh = params.checked || simplifies(params.simplify) ? 1 : 0.78;
  return {1, 1, solve, 0.15, mesh, 0.15};
}

/// Passes of a stage over its arrays, that read them and that write to them.
struct Passes {
  uint64_t read, written;
};
/// Estimating normals and finding areas: measured 8 to 20.
constexpr Passes passes_of_placing{14, 7};
/// Of the finest level: from the level above, two for each sixteen iterations, the gap, its labels; measured with what
/// the levels above it need.
constexpr Passes passes_of_solve{9, 9};
/// 25 to 30 iterations of the fit, in three rounds, and what chooses its weights.
constexpr Passes passes_of_refine{45, 18};
constexpr Passes passes_of_mesh{4, 3};

uint64_t share_of(uint64_t bytes, double share) { return static_cast<uint64_t>(share * static_cast<double>(bytes)); }

uint64_t share_and_small(uint64_t bytes, double share) {
  return std::min(bytes, share_of(bytes, share) + small_arrays);
}

/// Of bytes that contain the program's own.
uint64_t share_beside_program(uint64_t bytes, double share) {
  const uint64_t program = std::min(bytes, program_bytes);
  return program + share_of(bytes - program, share);
}

}  // namespace

ScratchBudget::ScratchBudget(const ReconstructParams& params, const Context& context)
    : params_(params),
      context_(context),
      folder_(has_scratch_files() ? context.state().scratch_folder : std::string()),
      moves_vectors_(context.state().move_vectors != nullptr) {
  if (!folder_.empty()) free_bytes_ = free_disk_bytes(folder_);
}

ScratchBudget::~ScratchBudget() {
  if (!used_) return;
  pages_of(context_).use_folder({});
  if (moves_vectors_) context_.state().move_vectors({});
}

void ScratchBudget::use() {
  check_scratch_folder(folder_);
  used_ = true;
  pages_of(context_).use_folder(folder_);
  if (moves_vectors_) context_.state().move_vectors(folder_);
}

bool ScratchBudget::takes(const MemoryPlan& plan, const Room& room) {
  if (folder_.empty() || (!used_ && plan.total() <= room.bytes)) return false;
  const MemoryPlan on_disk = disk_part(plan);
  if (on_disk.least() > free_bytes_)
    throw OutputError(fmt::format("scratch folder {}: about {} needed, {} free", folder_, format_bytes(on_disk.total()),
                                  format_bytes(free_bytes_)));
  if (!used_) {
    from_start_ = plan.fixed_bytes == 0;  // only placing is planned yet
    use();
  }
  return true;
}

bool ScratchBudget::holds(const MemoryPlan& plan, const Room& room) const {
  return !folder_.empty() && disk_part(plan).total() <= free_bytes_ && resident_part(plan).total() <= room.bytes;
}

MemoryPlan ScratchBudget::resident_part(const MemoryPlan& plan) const {
  const ResidentShares share = shares_of(params_, moves_vectors_);
  MemoryPlan part = plan;
  if (from_start_) part.placing_bytes = share_beside_program(plan.placing_bytes, share.placing);
  part.fixed_bytes = share_beside_program(plan.fixed_bytes, share.fixed);
  part.solve.bytes = share_and_small(plan.solve.bytes, share.solve);
  part.tables_bytes = share_of(plan.tables_bytes, share.solve);
  part.refine.bytes = share_and_small(plan.refine.bytes, share.refine);
  part.kept_bytes = share_of(plan.kept_bytes, share.solve);
  part.joint_bytes = share_of(plan.joint_bytes, share.solve);
  part.mesh.bytes =
      moves_vectors_ ? share_and_small(plan.mesh.bytes, share.mesh) : share_of(plan.mesh.bytes, share.mesh);
  if (moves_vectors_ && params_.checked) part.mesh.bytes = std::min(plan.mesh.bytes, part.mesh.bytes + least_tree);
  part.gap.bytes = share_of(plan.gap.bytes, share.gap);
  return part;
}

MemoryPlan ScratchBudget::disk_part(const MemoryPlan& plan) const {
  const MemoryPlan in_memory = resident_part(plan);
  MemoryPlan part = plan;
  part.placing_bytes -= in_memory.placing_bytes;
  part.fixed_bytes -= in_memory.fixed_bytes;
  part.solve.bytes -= in_memory.solve.bytes;
  part.tables_bytes -= in_memory.tables_bytes;
  part.refine.bytes -= in_memory.refine.bytes;
  part.kept_bytes -= in_memory.kept_bytes;
  part.joint_bytes -= in_memory.joint_bytes;
  part.mesh.bytes -= in_memory.mesh.bytes;
  part.gap.bytes -= in_memory.gap.bytes;
  return part;
}

ScratchTraffic ScratchBudget::traffic(const MemoryPlan& plan, const Room& room) const {
  const MemoryPlan in_memory = resident_part(plan), on_disk = disk_part(plan);
  ScratchTraffic sum;
  const auto add = [&](Passes passes, uint64_t disk, uint64_t memory) {
    const uint64_t cache = room.bytes - std::min(room.bytes, memory), beyond = disk - std::min(disk, cache);
    sum.read += passes.read * beyond;
    sum.written += passes.written * beyond;
  };
  if (from_start_) add(passes_of_placing, on_disk.placing_bytes, in_memory.placing_bytes);
  const uint64_t fixed = in_memory.fixed_bytes + in_memory.gap.bytes;
  add(passes_of_solve, on_disk.solve.bytes, fixed + in_memory.solve.bytes);
  add(passes_of_refine, on_disk.refine.bytes, fixed + in_memory.refine.bytes);
  add(passes_of_mesh, on_disk.mesh.bytes, fixed + in_memory.mesh.bytes);
  return sum;
}

}  // namespace soapfilm
