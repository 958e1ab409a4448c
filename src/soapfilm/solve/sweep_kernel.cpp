#include "soapfilm/solve/sweep_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "soapfilm/solve/sweep_kernel.cpp"
#include <hwy/foreach_target.h>
//
#include "soapfilm/solve/sweep_kernel-inl.h"

#if HWY_ONCE
#include "soapfilm/core/simd.h"

namespace soapfilm {

HWY_EXPORT(kernel);
SweepKernel scalar_sweep_kernel();

SweepKernel sweep_kernel() {
  return simd_target() == "scalar" ? scalar_sweep_kernel() : HWY_DYNAMIC_DISPATCH(kernel)();
}

}  // namespace soapfilm
#endif  // HWY_ONCE
