// The processes that mpirun, or another launcher of Open MPI, has started. The only folder that knows MPI.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "soapfilm/core/ranks.h"
#include "soapfilm/error.h"

namespace soapfilm {

/// Another rank has failed, or was cancelled: this one ends, too.
struct RankGaveUp : Cancelled {};

class MpiRanks final : public Ranks {
 public:
  /// Null where no launcher has started this process, or it alone.
  static std::shared_ptr<MpiRanks> join();
  ~MpiRanks() override;

  /// Called now and then while this rank waits; may throw.
  std::function<void()> while_waiting;

  /// How many ranks share this machine's memory.
  int on_this_machine() const;

  /// How this rank ends: its exit code, with a line that says why; or, after RankGaveUp, neither.
  struct End {
    int code = 0;
    std::string line;
    bool followed = false;  ///< another rank gave up first
  };
  /// Ends the run: waits for all ranks, and returns what the first of them to fail said, on each. The line is for rank
  /// 0 to print. Nothing may be exchanged after it. Where a rank does not answer all of them are ended.
  End leave(const End& own);
  /// Call last, when the line is printed: once a process has ended with a code other than 0 mpirun ends the others.
  void close();

 private:
  struct World;
  explicit MpiRanks(std::unique_ptr<World> world);
  void pass(const std::vector<Message>& out, const std::vector<Message>& in) override;
  void look_for_failures();
  void complete_open();
  void stop(size_t receives);
  End first_failure(const End& own) const;
  [[noreturn]] void abort(const End& own) const;

  std::unique_ptr<World> world_;
};

}  // namespace soapfilm
