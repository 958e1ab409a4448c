#include "soapfilm/simplify/coarser.h"

#include <cmath>
#include <utility>

#include "soapfilm/core/context_state.h"

namespace soapfilm {

std::vector<Simplified> coarser_levels(const Simplified& first, size_t count, const Context& context) {
  std::vector<Simplified> levels;
  levels.reserve(count);  // `finer` points into it
  const Simplified* finer = &first;
  while (levels.size() < count) {
    // Each level has about half of the triangles before, and takes half of the time.
    const double begin = 1 - std::ldexp(1.0, -static_cast<int>(levels.size())), end = (1 + begin) / 2;
    Simplified level = simplify(finer->mesh, 2 * finer->report.tolerance, part_of(context, begin, end));
    if (level.report.triangles >= finer->report.triangles) break;
    level.report.proved = std::nextafter(finer->report.proved + level.report.proved, Box3d::infinity);
    levels.push_back(std::move(level));
    finer = &levels.back();
  }
  return levels;
}

}  // namespace soapfilm
