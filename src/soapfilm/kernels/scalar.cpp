// The back end without SIMD instructions: for machines that have none, and as the reference of the tests.
#include "soapfilm/kernels/kernels.h"

namespace soapfilm {

BackEnd scalar_back_end() {
  return {[] { return std::vector<std::string>{"scalar"}; },
          [](const std::string&) -> Kernels {
            return {{scalar_sweep_kernel(Norm::isotropic), scalar_sweep_kernel(Norm::anisotropic)},
                    {scalar_energy_kernel(Norm::isotropic), scalar_energy_kernel(Norm::anisotropic)},
                    scalar_divergence_kernel(),
                    scalar_sor_kernel(),
                    scalar_row_kernel()};
          }};
}

}  // namespace soapfilm
