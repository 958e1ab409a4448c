// What the fields of a scan in an E57 file mean for its samples.
#pragma once

#include <string>
#include <vector>

#include "soapfilm/io/e57/e57_head.h"
#include "soapfilm/io/point_columns.h"

namespace soapfilm::io {

/// Indices into E57Scan::fields; Triple::absent for none.
struct E57Layout {
  Triple position;  ///< x, y, z; if spherical range, azimuth, elevation
  bool spherical = false;
  Triple normal;
  Triple sensor;
  Triple color;
  size_t weight = Triple::absent;
  size_t position_state = Triple::absent;  ///< not 0: no return
  size_t color_state = Triple::absent;     ///< not 0: no color
  size_t row = Triple::absent;             ///< with `column`, else neither
  size_t column = Triple::absent;
  size_t return_index = Triple::absent;

  /// A field that becomes a column of the cloud.
  struct Further {
    size_t field = 0;
    std::string name{};
    size_t state = Triple::absent;  ///< not 0: no value
    bool from_first = false;        ///< a time: counted from its first value, as float holds no dates
  };
  std::vector<Further> further;

  bool has_cells() const { return row != Triple::absent; }
  /// Of all fields: is it decoded?
  std::vector<bool> used(size_t fields) const;
};

/// Throws InputError for a scan without positions. Names fields that are not used in `ignored`.
E57Layout e57_layout(const E57Scan& scan, const std::string& path, std::vector<std::string>& ignored);

}  // namespace soapfilm::io
