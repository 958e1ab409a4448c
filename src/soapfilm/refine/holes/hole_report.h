// What happened to the holes: where no sample covers the surface.
#pragma once

#include <cstddef>
#include <cstdint>

namespace soapfilm {

struct HoleReport {
  size_t curved = 0;   ///< holes filled with the curvature around them
  size_t left = 0;     ///< left flat: the unseen base of an object, or a surface that ends at the grid's border
  size_t flips = 0;    ///< vertices of the grid that changed their label
  int64_t gained = 0;  ///< of these, those that came inside less those that went outside: the volume of the curving
  size_t refused = 0;  ///< that would have changed the topology and did not
  int rounds = 0;      ///< of fits and label changes; at most 12
};

}  // namespace soapfilm
