// The functions of reconstruct.h, implemented by reconstruct.cpp.
#include <utility>

#include "soapfilm/reconstruct.h"
#include "soapfilm/run/order_samples.h"
#include "soapfilm/run/run.h"

namespace soapfilm {

Reconstruction reconstruct(const PointCloud& cloud, const ReconstructParams& params, const Context& context) {
  Reconstruction result = run(cloud, nullptr, params, context);
  remove_kept_stages(context);
  return result;
}

Reconstruction reconstruct(PointCloud&& cloud, const ReconstructParams& params, const Context& context) {
  PointCloud owned = std::move(cloud);
  order_samples(owned, context);
  Reconstruction result = run(owned, &owned, params, context);
  remove_kept_stages(context);
  return result;
}

}  // namespace soapfilm
