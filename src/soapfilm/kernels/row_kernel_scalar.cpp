// The scalar target: one float per lane, for machines without SIMD and as the reference of the tests.
#define HWY_COMPILE_ONLY_SCALAR
#include "soapfilm/kernels/row_kernel-inl.h"

namespace soapfilm {

RowKernel scalar_row_kernel() { return HWY_STATIC_DISPATCH(rows)(); }

}  // namespace soapfilm
