#include "soapfilm/simplify/check_editable.h"

#include <fmt/format.h>

#include <optional>

#include "soapfilm/core/memory.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/simplify/engine.h"

namespace soapfilm {

void check_room(const Mesh& mesh, const char* doing, uint64_t needed, const Context& context) {
  const std::optional<size_t> limit = context.memory_limit();
  const uint64_t room = limit ? *limit : available_memory_bytes();
  if (needed > room)
    throw MemoryError(fmt::format("memory: {} {} triangles needs about {}, {} is {}", doing, mesh.triangles.size(),
                                  format_bytes(needed), limit ? "the limit" : "free memory", format_bytes(room)));
}

void check_editable(const Mesh& mesh, const char* doing, uint64_t needed, const Context& context) {
  constexpr double longest_side = 1e100;
  const size_t n = mesh.vertices.size();
  for (size_t v = 0; v < n; ++v)
    if (!is_finite(mesh.vertices[v])) throw ParameterError(fmt::format("mesh: vertex {} is not finite", v));
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const uint32_t v : mesh.triangles[t])
      if (v >= n) throw ParameterError(fmt::format("mesh: triangle {}: vertex {}, must be below {}", t, v, n));
  if (mesh.triangles.size() > most_simplified)
    throw ParameterError(fmt::format("mesh: {} triangles, must be at most {}", mesh.triangles.size(), most_simplified));
  check_room(mesh, doing, needed, context);
  if (n > 0 && !(mesh.box().longest() <= longest_side))
    throw ParameterError(
        fmt::format("mesh: its box is {:g} long, must be at most {:g}", mesh.box().longest(), longest_side));
}

}  // namespace soapfilm
