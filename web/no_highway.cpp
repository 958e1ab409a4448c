// In place of the SIMD back end: browsers run the scalar one.
#include "soapfilm/kernels/kernels.h"

namespace soapfilm {

BackEnd highway_back_end() {
  return {[] { return std::vector<std::string>{}; }, [](const std::string&) -> Kernels { return {}; }};
}

}  // namespace soapfilm
