#include "soapfilm/simplify/collapsed_mesh.h"

#include <algorithm>

#include "soapfilm/core/triangle_distance.h"

namespace soapfilm {

CollapsedMesh::CollapsedMesh(const Mesh& given, const Written& written_as)
    : EditedMesh(given, written_as),
      quadric(original.size()),
      version(original.size()),
      border(original.size(), none),
      stamp(was.triangles()),
      first_owned(was.triangles(), none),
      next_owned(original.size(), none),
      owner(original.size(), none) {
  for (uint32_t t = 0; t < was.triangles(); ++t) {
    const Vec3d n = cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
    const double area = 0.5 * norm(n);
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t v = was.corners(t)[k], to = was.corners(t)[(k + 1) % 3];
      if (area > 0) quadric[v].add_plane(normalized(n), position[v], area / 3);
      if (owner[v] == none) own(t, v);
      if (mesh.twin(3 * t + k) != none) continue;
      // A plane through the border keeps it from sinking into the surface.
      border[v] = to;
      const Vec3d along = position[to] - position[v], across = normalized(cross(along, n));
      for (const uint32_t end : {v, to}) quadric[end].add_plane(across, position[v], dot(along, along) / 2);
    }
  }
}

CollapseLog& CollapsedMesh::log_of(uint32_t number) {
  const auto after = std::upper_bound(logs.begin(), logs.end(), number,
                                      [](uint32_t n, const CollapseLog& log) { return n < log.base; });
  return *(after - 1);
}

bool CollapsedMesh::is_done(uint32_t number) {
  const CollapseLog& log = log_of(number);
  return !log.collapses[number - log.base].undone;
}

void CollapsedMesh::undo(uint32_t number, std::vector<uint32_t>& touched) {
  std::vector<uint32_t> pending{number};
  while (!pending.empty()) {
    const uint32_t top = pending.back();
    CollapseLog& log = log_of(top);
    const size_t index = top - log.base;
    const size_t end = index + 1 < log.collapses.size() ? log.collapses[index + 1].stamps : log.before.size();
    uint32_t later = 0;
    for (size_t i = log.collapses[index].stamps; i < end; ++i) later = std::max(later, stamp[log.before[i].triangle]);
    if (later > top) {
      pending.push_back(later);
      continue;
    }
    undo_one(log, index, touched);
    log.collapses[index].undone = true;
    for (size_t i = log.collapses[index].stamps; i < end; ++i) {
      stamp[log.before[i].triangle] = log.before[i].before;
      touched.push_back(log.before[i].triangle);
    }
    pending.pop_back();
  }
}

/// The original vertices around get owners among the triangles that are there again.
void CollapsedMesh::undo_one(const CollapseLog& log, size_t index, std::vector<uint32_t>& touched) {
  const CollapseLog::Collapse& c = log.collapses[index];
  std::vector<uint32_t> vertices, star;
  const auto add = [&](uint32_t h) {
    if (std::find(star.begin(), star.end(), h / 3) == star.end()) star.push_back(h / 3);
  };
  mesh.for_fan(c.kept, add);
  for (const uint32_t t : star) {
    for (uint32_t v = first_owned[t]; v != none; v = next_owned[v]) vertices.push_back(v);
    first_owned[t] = none;
  }
  mesh.undo(c.half_edge, c.kept);
  position[c.kept] = c.place;
  const uint32_t other = mesh.from(c.half_edge) == c.kept ? mesh.to(c.half_edge) : mesh.from(c.half_edge);
  ++version[c.kept];
  ++version[other];
  mesh.for_fan(c.kept, add);
  mesh.for_fan(other, add);
  for (const uint32_t v : vertices) {
    uint32_t nearest = star[0];
    double least = Box3d::infinity;
    for (const uint32_t t : star) {
      const double d = squared_distance(original[v], corner(t, 0), corner(t, 1), corner(t, 2));
      if (d < least) {
        least = d;
        nearest = t;
      }
    }
    own(nearest, v);
  }
  touched.insert(touched.end(), star.begin(), star.end());
}

}  // namespace soapfilm
