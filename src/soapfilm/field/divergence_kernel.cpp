#include "soapfilm/field/divergence_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "soapfilm/field/divergence_kernel.cpp"
#include <hwy/foreach_target.h>
//
#include "soapfilm/field/divergence_kernel-inl.h"

#if HWY_ONCE
#include "soapfilm/core/dispatch-inl.h"

namespace soapfilm {

HWY_EXPORT(kernel);
DivergenceKernel scalar_divergence_kernel();

DivergenceKernel divergence_kernel(const SimdTarget& simd) {
  return simd.is_scalar() ? scalar_divergence_kernel() : SOAPFILM_DISPATCH(simd, kernel)();
}

}  // namespace soapfilm
#endif  // HWY_ONCE
