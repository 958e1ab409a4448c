// What a method has (docs/reference/methods.md compares them).
#pragma once

#include "soapfilm/params.h"

namespace soapfilm {

/// Does the method have a dual, and so a bound of the optimum of (4)?
inline bool is_certified(Method method) { return method == Method::tv || method == Method::tv_sor; }

/// Does the surface depend on the weight of area, lambda? poisson's is linear in it, vrip knows none.
inline bool uses_lambda(Method method) { return method != Method::poisson && method != Method::vrip; }

}  // namespace soapfilm
