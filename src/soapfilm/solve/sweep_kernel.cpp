#include "soapfilm/solve/sweep_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "soapfilm/solve/sweep_kernel.cpp"
#include <hwy/foreach_target.h>
//
#include "soapfilm/solve/sweep_kernel-inl.h"

#if HWY_ONCE
#include "soapfilm/core/dispatch-inl.h"

namespace soapfilm {

HWY_EXPORT(kernel);
SweepKernel scalar_sweep_kernel(Norm norm);

SweepKernel sweep_kernel(const SimdTarget& simd, Norm norm) {
  return simd.is_scalar() ? scalar_sweep_kernel(norm) : SOAPFILM_DISPATCH(simd, kernel)(norm);
}

}  // namespace soapfilm
#endif  // HWY_ONCE
