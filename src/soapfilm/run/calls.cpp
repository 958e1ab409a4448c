// The functions of reconstruct.h, implemented by reconstruct.cpp.
#include <utility>

#include "soapfilm/reconstruct.h"
#include "soapfilm/run/order_samples.h"
#include "soapfilm/run/run.h"

namespace soapfilm {

Reconstruction reconstruct(const PointCloud& cloud, const ReconstructParams& params, const Context& context) {
  return run(cloud, nullptr, params, context);
}

Reconstruction reconstruct(PointCloud&& cloud, const ReconstructParams& params, const Context& context) {
  PointCloud owned = std::move(cloud);
  order_samples(owned, context);
  return run(owned, &owned, params, context);
}

}  // namespace soapfilm
