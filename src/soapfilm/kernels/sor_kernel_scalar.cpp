// The scalar target: one float per lane, for machines without SIMD and as the reference of the tests.
#define HWY_COMPILE_ONLY_SCALAR
#include "soapfilm/kernels/sor_kernel-inl.h"

namespace soapfilm {

SorKernel scalar_sor_kernel() { return HWY_STATIC_DISPATCH(sor_row_kernel)(); }

}  // namespace soapfilm
