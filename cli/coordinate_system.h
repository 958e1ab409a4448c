// What a coordinate system in well-known text (WKT) says to a person: its name and its unit of length.
#pragma once

#include <string>
#include <string_view>

namespace soapfilm::cli {

struct CoordinateSystem {
  std::string name;  ///< such as "WGS 84 / UTM zone 32N"; "EPSG:25832" as it is
  std::string unit;  ///< of x and y, such as "metre"; empty: not said
};

/// `text`: WKT 1 or 2, or "EPSG:" and a number. Never fails: what is not understood is empty, or the text itself.
CoordinateSystem coordinate_system_of(std::string_view text);

}  // namespace soapfilm::cli
