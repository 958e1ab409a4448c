// Scans as they come: a cloud that grows, each scan moved by its pose.
#include <fmt/format.h>

#include <string>
#include <utility>

#include "soapfilm/core/cloud_layout.h"
#include "soapfilm/core/placement.h"
#include "soapfilm/error.h"
#include "soapfilm/reconstruct.h"

namespace soapfilm {

namespace {

/// A scan whose samples do not say where its scanner was gets the origin of its pose.
void add_sensor(const Placement& pose, PointCloud& scans) {
  if (!scans.sensors.empty()) return;
  for (Scan& scan : scans.scans)
    if (!scan.sensor && !scan.view_direction) scan.sensor = pose.translation;
}

}  // namespace

void Reconstructor::add(PointCloud scan, const std::array<double, 16>* pose) {
  check_layout(scan);
  if (scan.scans.empty()) scan.scans.emplace_back().end = scan.size();
  if (pose) {
    std::string error;
    const Placement placement = placement_of_matrix(*pose, error);
    if (!error.empty()) throw ParameterError(fmt::format("pose: the matrix {}", error));
    place_cloud(placement, scan);
    add_sensor(placement, scan);
  }
  cloud_.append(std::move(scan));
}

Reconstruction Reconstructor::reconstruct(const ReconstructParams& params, const Context& context) const {
  return soapfilm::reconstruct(cloud_, params, context);
}

}  // namespace soapfilm
