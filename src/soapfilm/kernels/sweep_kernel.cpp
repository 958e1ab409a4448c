#include "soapfilm/kernels/sweep_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "soapfilm/kernels/sweep_kernel.cpp"
#include <hwy/foreach_target.h>
//
#include "soapfilm/kernels/sweep_kernel-inl.h"

#if HWY_ONCE
#include "soapfilm/kernels/dispatch-inl.h"

namespace soapfilm {

HWY_EXPORT(kernel);
SweepKernel highway_sweep_kernel(int64_t bits, Norm norm) { return SOAPFILM_DISPATCH(bits, kernel)(norm); }

}  // namespace soapfilm
#endif  // HWY_ONCE
