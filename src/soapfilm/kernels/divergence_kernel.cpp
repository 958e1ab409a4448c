#include "soapfilm/kernels/divergence_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "soapfilm/kernels/divergence_kernel.cpp"
#include <hwy/foreach_target.h>
//
#include "soapfilm/kernels/divergence_kernel-inl.h"

#if HWY_ONCE
#include "soapfilm/kernels/dispatch-inl.h"

namespace soapfilm {

HWY_EXPORT(kernel);
DivergenceKernel highway_divergence_kernel(int64_t bits) { return SOAPFILM_DISPATCH(bits, kernel)(); }

}  // namespace soapfilm
#endif  // HWY_ONCE
