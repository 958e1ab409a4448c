// A run larger than memory: which part of its plan is on disk, in the context's scratch folder.
#pragma once

#include <cstdint>
#include <string>

#include "soapfilm/context.h"
#include "soapfilm/params.h"

namespace soapfilm {

struct MemoryPlan;
struct Room;

/// Bytes that go between memory and disk.
struct ScratchTraffic {
  uint64_t read = 0, written = 0;
};

/// Moves a run's large arrays to the scratch folder once its plan exceeds the memory, if the context names one.
class ScratchBudget {
 public:
  /// Keeps references.
  ScratchBudget(const ReconstructParams& params, const Context& context);
  /// The next run begins in memory.
  ~ScratchBudget();
  ScratchBudget(const ScratchBudget&) = delete;
  ScratchBudget& operator=(const ScratchBudget&) = delete;

  /// Whether arrays are on disk from now on: they were, or the plan exceeds the room and a folder is given. Throws
  /// OutputError, before anything is written, where the certain part of what goes to disk exceeds the free space.
  bool takes(const MemoryPlan& plan, const Room& room);
  bool used() const { return used_; }
  /// Whether the plan fits, where its arrays are on disk.
  bool holds(const MemoryPlan& plan, const Room& room) const;
  const std::string& folder() const { return folder_; }

  /// What stays in memory of a plan whose arrays are on disk, stage by stage; and what is on disk.
  MemoryPlan resident_part(const MemoryPlan& plan) const;
  MemoryPlan disk_part(const MemoryPlan& plan) const;
  /// What memory has no room for goes to the disk and comes back in each pass of a stage over its arrays. About: the
  /// system chooses what stays.
  ScratchTraffic traffic(const MemoryPlan& plan, const Room& room) const;

 private:
  void use();

  const ReconstructParams& params_;
  const Context& context_;
  std::string folder_;       ///< empty: none
  bool moves_vectors_;       ///< not only the library's own arrays
  uint64_t free_bytes_ = 0;  ///< of the disk, before the run
  bool used_ = false;
  bool from_start_ = false;  ///< also while samples are placed
};

}  // namespace soapfilm
