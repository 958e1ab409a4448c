#include "soapfilm/refine/row_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "soapfilm/refine/row_kernel.cpp"
#include <hwy/foreach_target.h>
//
#include "soapfilm/refine/row_kernel-inl.h"

#if HWY_ONCE
#include "soapfilm/core/simd.h"

namespace soapfilm {

HWY_EXPORT(rows);
RowKernel scalar_row_kernel();

RowKernel row_kernel() { return scalar_forced() ? scalar_row_kernel() : HWY_DYNAMIC_DISPATCH(rows)(); }

}  // namespace soapfilm
#endif  // HWY_ONCE
