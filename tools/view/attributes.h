// What vertices and samples can be colored by, besides their colors.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/mesh.h"

namespace soapfilm::view_detail {

struct ShownAttribute {
  nlohmann::ordered_json facts;  ///< name; lo, hi; low, high: without 2 % at both ends; labels, codes; length
  std::vector<float> values;     ///< not-a-number where there is none
};

/// Columns with at least one finite value.
std::vector<ShownAttribute> shown_attributes(const Mesh& mesh);
/// Also the scan, where there are several, and the weight.
std::vector<ShownAttribute> shown_attributes(const PointCloud& cloud);

}  // namespace soapfilm::view_detail
