// Which SIMD instructions the kernels use. They are chosen at run time; results do not depend on the choice.
#pragma once

#include <string>
#include <vector>

namespace soapfilm {

/// The targets that this processor can run, best first; the last is always "scalar".
std::vector<std::string> simd_targets();

/// The one in use.
std::string simd_target();

/// Whether that is "scalar" because force_simd_target() said so. simd_target() asks the processor each time, which
/// takes microseconds in a virtual machine; this does not.
bool scalar_forced();

/// Makes all kernels of this process use a target by name (as simd_targets() lists them; empty: the best). For tests
/// and benchmarks; not to be called while kernels run. Throws ParameterError for a target that cannot run here.
void force_simd_target(const std::string& name);

}  // namespace soapfilm
