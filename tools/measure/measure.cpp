#include "tools/measure/measure.h"

#include <cmath>
#include <utility>

#include "soapfilm/error.h"

namespace soapfilm {

Measures measure(const Mesh& mesh, const MeasureOptions& options, const Context& context, const Mesh* base,
                 const Mesh* before) {
  if (mesh.triangles.empty()) throw ParameterError("the mesh has 0 triangles, must have at least 1");
  if (options.above && options.columns.window && std::abs(options.above->normal.z) != 1)
    throw ParameterError("a window has vertical walls: the plane beside it must be z=Z");
  Measures out;
  out.topology = check_topology(mesh);
  out.box = mesh.box();
  out.area = mesh.area();
  Mesh turned;
  const Mesh* solid = &mesh;
  if (out.topology.closed()) {
    const double volume = mesh.volume();
    out.volume = std::abs(volume);
    out.inside_out = volume < 0;
    if (out.inside_out) {
      turned.vertices = mesh.vertices;
      turned.triangles = mesh.triangles;
      for (Triangle& t : turned.triangles) std::swap(t[1], t[2]);
      solid = &turned;
    }
  }
  if (options.above)
    out.at_plane = volume_at_plane(*solid, out.topology.closed(), *options.above, options.columns.window);
  for (const Plane& plane : options.sections) out.sections.push_back(section(*solid, plane));
  if (base) out.above_mesh = volumes_between(*solid, *base, options.columns, context);
  if (before) out.since = volumes_between(*solid, *before, options.columns, context);
  return out;
}

}  // namespace soapfilm
