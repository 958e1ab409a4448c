#include "soapfilm/kernels/energy_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "soapfilm/kernels/energy_kernel.cpp"
#include <hwy/foreach_target.h>
//
#include "soapfilm/kernels/energy_kernel-inl.h"

#if HWY_ONCE
#include "soapfilm/kernels/dispatch-inl.h"

namespace soapfilm {

HWY_EXPORT(energy_kernel);
EnergyKernel highway_energy_kernel(int64_t bits, Norm norm) { return SOAPFILM_DISPATCH(bits, energy_kernel)(norm); }

}  // namespace soapfilm
#endif  // HWY_ONCE
