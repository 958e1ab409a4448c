#include "soapfilm/solve/energy_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "soapfilm/solve/energy_kernel.cpp"
#include <hwy/foreach_target.h>
//
#include "soapfilm/solve/energy_kernel-inl.h"

#if HWY_ONCE
#include "soapfilm/core/dispatch-inl.h"

namespace soapfilm {

HWY_EXPORT(energy_kernel);
EnergyKernel scalar_energy_kernel(Norm norm);

EnergyKernel energy_kernel(const SimdTarget& simd, Norm norm) {
  return simd.is_scalar() ? scalar_energy_kernel(norm) : SOAPFILM_DISPATCH(simd, energy_kernel)(norm);
}

}  // namespace soapfilm
#endif  // HWY_ONCE
