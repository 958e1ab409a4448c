// The order of a cloud that is on disk.
#pragma once

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"

namespace soapfilm {

/// Puts the samples of each scan in an order along space, where the run's arrays will be in the context's scratch
/// folder: stages that go along space then read near samples together. No mesh depends on the order. Range images stay
/// as they are, and so do clouds that a run will refuse, since messages name samples by their numbers.
void order_samples(PointCloud& cloud, const Context& context);

/// The same wherever the cloud is.
void order_scans_by_place(PointCloud& cloud);

}  // namespace soapfilm
