#include "soapfilm/refine/row_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "soapfilm/refine/row_kernel.cpp"
#include <hwy/foreach_target.h>
//
#include "soapfilm/refine/row_kernel-inl.h"

#if HWY_ONCE
#include "soapfilm/core/dispatch-inl.h"

namespace soapfilm {

HWY_EXPORT(rows);
RowKernel scalar_row_kernel();

RowKernel row_kernel(const SimdTarget& simd) {
  return simd.is_scalar() ? scalar_row_kernel() : SOAPFILM_DISPATCH(simd, rows)();
}

}  // namespace soapfilm
#endif  // HWY_ONCE
