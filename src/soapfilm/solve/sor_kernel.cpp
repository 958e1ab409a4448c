#include "soapfilm/solve/sor_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "soapfilm/solve/sor_kernel.cpp"
#include <hwy/foreach_target.h>
//
#include "soapfilm/solve/sor_kernel-inl.h"

#if HWY_ONCE
#include "soapfilm/core/simd.h"

namespace soapfilm {

HWY_EXPORT(sor_row_kernel);
SorKernel scalar_sor_kernel();

SorKernel sor_kernel() { return scalar_forced() ? scalar_sor_kernel() : HWY_DYNAMIC_DISPATCH(sor_row_kernel)(); }

}  // namespace soapfilm
#endif  // HWY_ONCE
