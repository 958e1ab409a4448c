// Chooses the function of a HWY_EXPORT() table for a run. Highway's own HWY_DYNAMIC_DISPATCH chooses per process, for
// runs of all targets. Included once, after <hwy/foreach_target.h>, by the file that exports.
#include <hwy/highway.h>
#include <hwy/targets.h>

#include <cstddef>
#include <cstdint>

namespace soapfilm {

/// The index in this file's tables of the best target among those of `bits`, as Highway numbers them.
inline size_t table_index([[maybe_unused]] int64_t bits) {
#if HWY_IDE || ((HWY_TARGETS & (HWY_TARGETS - 1)) == 0)
  return 0;  // only one target was compiled
#else
  hwy::ChosenTarget chosen;
  chosen.Update(bits);
  return chosen.GetIndex();
#endif
}

}  // namespace soapfilm

#define SOAPFILM_DISPATCH(bits, function) (*HWY_DISPATCH_TABLE(function)[table_index(bits)])
