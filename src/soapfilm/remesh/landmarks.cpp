#include "soapfilm/remesh/landmarks.h"

#include <algorithm>
#include <limits>

#include "soapfilm/core/triangle_distance.h"
#include "soapfilm/simplify/cells.h"

namespace soapfilm {

Landmarks::Landmarks(const std::vector<Vec3d>& places, double side, double distance)
    : first_(places.size(), none), squared_distance_(distance * distance) {
  CellTable taken;
  for (uint32_t v = 0; v < places.size(); ++v) {
    const size_t cells = taken.size();
    taken.insert(cell_key(cell_of(places[v], 1 / side)));
    if (taken.size() == cells) continue;
    first_[v] = static_cast<uint32_t>(place_.size());
    place_.push_back(places[v]);
  }
  last_ = first_;
  next_.assign(place_.size(), none);
}

bool Landmarks::stay_near(uint32_t vertex, const std::vector<Corners>& were, const std::vector<Corners>& become) const {
  if (vertex >= first_.size()) return true;
  for (uint32_t i = first_[vertex]; i != none; i = next_[i]) {
    const auto squared_distance_to = [&](const std::vector<Corners>& triangles) {
      double least = std::numeric_limits<double>::infinity();
      for (const Corners& t : triangles) least = std::min(least, squared_distance(place_[i], t[0], t[1], t[2]));
      return least;
    };
    const double then = squared_distance_to(become);
    if (!(then <= squared_distance_) && !(then <= squared_distance_to(were))) return false;
  }
  return true;
}

void Landmarks::hand_over(uint32_t gone, uint32_t kept) {
  if (gone >= first_.size() || first_[gone] == none) return;
  if (kept >= first_.size()) {  // a vertex that a split made
    first_.resize(kept + size_t{1}, none);
    last_.resize(kept + size_t{1}, none);
  }
  (first_[kept] == none ? first_[kept] : next_[last_[kept]]) = first_[gone];
  last_[kept] = last_[gone];
  first_[gone] = last_[gone] = none;
}

}  // namespace soapfilm
