#include "soapfilm/kernels/sor_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "soapfilm/kernels/sor_kernel.cpp"
#include <hwy/foreach_target.h>
//
#include "soapfilm/kernels/sor_kernel-inl.h"

#if HWY_ONCE
#include "soapfilm/kernels/dispatch-inl.h"

namespace soapfilm {

HWY_EXPORT(sor_row_kernel);
SorKernel highway_sor_kernel(int64_t bits) { return SOAPFILM_DISPATCH(bits, sor_row_kernel)(); }

}  // namespace soapfilm
#endif  // HWY_ONCE
