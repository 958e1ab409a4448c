// The scalar target: one float per lane, for machines without SIMD and as the reference of the tests.
#define HWY_COMPILE_ONLY_SCALAR
#include "soapfilm/kernels/divergence_kernel-inl.h"

namespace soapfilm {

DivergenceKernel scalar_divergence_kernel() { return HWY_STATIC_DISPATCH(kernel)(); }

}  // namespace soapfilm
