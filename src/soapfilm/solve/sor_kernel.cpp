#include "soapfilm/solve/sor_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "soapfilm/solve/sor_kernel.cpp"
#include <hwy/foreach_target.h>
//
#include "soapfilm/solve/sor_kernel-inl.h"

#if HWY_ONCE
#include "soapfilm/core/dispatch-inl.h"

namespace soapfilm {

HWY_EXPORT(sor_row_kernel);
SorKernel scalar_sor_kernel();

SorKernel sor_kernel(const SimdTarget& simd) {
  return simd.is_scalar() ? scalar_sor_kernel() : SOAPFILM_DISPATCH(simd, sor_row_kernel)();
}

}  // namespace soapfilm
#endif  // HWY_ONCE
