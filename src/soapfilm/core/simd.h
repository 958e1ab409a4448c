// Which SIMD instructions the kernels use. They are chosen at run time; results do not depend on the choice.
#pragma once

#include <string>
#include <vector>

namespace soapfilm {

/// The targets that this processor can run, best first; the last is always "scalar".
std::vector<std::string> simd_targets();

/// Whether kernels are to be scalar because force_simd_target() said so.
bool scalar_forced();

/// Makes all kernels of this process use a target by name (as simd_targets() lists them; empty: the best). For tests
/// and benchmarks; not to be called while kernels run. Throws ParameterError for a target that cannot run here.
void force_simd_target(const std::string& name);

}  // namespace soapfilm
