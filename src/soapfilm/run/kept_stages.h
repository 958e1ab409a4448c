// Finished stages of a run, kept in files of the scratch folder: after a crash the same run goes on from there.
#pragma once

#include <functional>
#include <string>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/orient/find_directions.h"
#include "soapfilm/params.h"
#include "soapfilm/pyramid/coarse_to_fine.h"
#include "soapfilm/run/memory_plan.h"
#include "soapfilm/run/surface.h"

namespace soapfilm {

/// Of one run, or of one rank of it: directions, the levels of the solve, and the refined surface. A file has the plan
/// of memory, too, so that what follows a stage is as if that had just ended. Files are complete or absent, and of the
/// same program, input and parameters by their names.
class KeptStages {
 public:
  /// None where the context does not ask for it (Context::set_resume()). Throws OutputError where the folder cannot be
  /// written. Keeps references.
  KeptStages(const PointCloud& cloud, const ReconstructParams& params, MemoryBudget& memory, const Context& context);

  /// What is kept, else what `make` finds. It is kept by keep(), once it is known what the run needs of the disk.
  Orientation orient(const std::function<Orientation()>& make);
  void keep(const Orientation& found);
  /// What is kept, else what `make` finds, which then is. A warning says where there is no room for it.
  Surface refine(const std::function<Surface()>& make);
  /// `user`, and kept levels are not solved again.
  PyramidObserver watch(PyramidObserver user);

 private:
  bool on() const { return !prefix_.empty(); }
  std::string file(const std::string& stage) const;
  /// The first rank that cannot, or -1.
  int first_that_cannot(bool this_one) const;
  /// read(archive) from the stage's file, if there is one.
  bool load(const std::string& stage, const std::function<void(std::istream&)>& read);
  bool could_save(const std::string& stage, const std::function<void(std::ostream&)>& write);
  void save(const std::string& stage, const std::function<void(std::ostream&)>& write);

  MemoryBudget& memory_;
  const Context& context_;
  bool has_directions_ = false;
  std::string prefix_;  ///< of the files of this run, with their folder; empty: none are kept
};

}  // namespace soapfilm
