// Clouds for Python: from arrays, from files, and as arrays again.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "soapfilm/io.h"
#include "soapfilm/report.h"

namespace soapfilm::python {

/// A cloud, and how it was read.
struct Points {
  std::shared_ptr<PointCloud> cloud = std::make_shared<PointCloud>();
  ReadReport read;                   ///< empty for arrays
  std::optional<StageTime> reading;  ///< of files
};

/// The cloud for a run that may use it up: if nobody looks at its arrays it is taken out of `points`, else copied.
PointCloud take_cloud(Points& points);

void add_points(pybind11::module_& module);

}  // namespace soapfilm::python
