// The scalar target: one float per lane, for machines without SIMD and as the reference of the tests.
#define HWY_COMPILE_ONLY_SCALAR
#include "soapfilm/kernels/energy_kernel-inl.h"

namespace soapfilm {

EnergyKernel scalar_energy_kernel(Norm norm) { return HWY_STATIC_DISPATCH(energy_kernel)(norm); }

}  // namespace soapfilm
