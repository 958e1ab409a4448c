#include "soapfilm/kernels/row_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "soapfilm/kernels/row_kernel.cpp"
#include <hwy/foreach_target.h>
//
#include "soapfilm/kernels/row_kernel-inl.h"

#if HWY_ONCE
#include "soapfilm/kernels/dispatch-inl.h"

namespace soapfilm {

HWY_EXPORT(rows);
RowKernel highway_row_kernel(int64_t bits) { return SOAPFILM_DISPATCH(bits, rows)(); }

}  // namespace soapfilm
#endif  // HWY_ONCE
