// The scalar target: one float per lane, for machines without SIMD and as the reference of the tests.
#define HWY_COMPILE_ONLY_SCALAR
#include "soapfilm/kernels/sweep_kernel-inl.h"

namespace soapfilm {

SweepKernel scalar_sweep_kernel(Norm norm) { return HWY_STATIC_DISPATCH(kernel)(norm); }

}  // namespace soapfilm
