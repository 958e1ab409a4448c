// The page that reads aloud: from a mesh to a smaller one.
#include "soapfilm/simplify.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/simplify/carry_over.h"
#include "soapfilm/simplify/check_editable.h"
#include "soapfilm/simplify/engine.h"
#include "soapfilm/simplify/rounds.h"

namespace soapfilm {

namespace {

/// Nothing to collapse, or no distance left beside the rounding of coordinates.
Simplified unchanged(const Mesh& mesh, double tolerance) {
  return {mesh, {mesh.triangles.size(), mesh.triangles.size(), tolerance, 0}};
}

class Simplification {
 public:
  Simplification(const Mesh& mesh, double tolerance, const SimplifyChecks& checks)
      : mesh_(mesh),
        written_(mesh, tolerance),
        now_(mesh, written_),
        grid_(now_.original, now_.was.all_corners()),
        checks_(checks) {}

  /// What rounding takes of a tolerance cannot be given to collapses.
  double distance(double tolerance) const {
    return (tolerance - written_.moved() - written_.slack()) / written_.unit();
  }
  size_t triangles() const { return now_.count_alive(); }
  void fix(std::vector<uint8_t> vertices) { now_.fixed = std::move(vertices); }

  void collapse(double tolerance, const Context& context) {
    ThinPlaces thin(now_, distance(tolerance));
    CollapseRun run{now_, grid_, thin, distance(tolerance), checks_, false};
    collapse_edges(run, std::vector<uint8_t>(now_.position.size(), 1), context);
  }

  /// Places where the proof fails are collapsed again, each collapse with its own proof.
  Simplified prove(double tolerance, const Context& context) {
    constexpr int most_repeats = 3;
    Proof proof(now_, grid_, distance(tolerance), checks_, context);
    for (int repeats = 0; !proof.holds(); ++repeats) {
      if (repeats >= most_repeats) continue;
      ThinPlaces thin(now_, distance(tolerance));
      CollapseRun run{now_, grid_, thin, distance(tolerance), checks_, true};
      collapse_edges(run, proof.changed_vertices(), silenced(context));
    }
    SimplifyReport report{mesh_.triangles.size(), triangles(), tolerance, 0};
    report.proved = std::min(proof.proved() * written_.unit() + written_.moved() + written_.slack(), tolerance);
    return {carry_over(mesh_, now_, grid_, distance(tolerance), context), report};
  }

 private:
  const Mesh& mesh_;
  Written written_;
  CollapsedMesh now_;
  FaceGrid grid_;
  SimplifyChecks checks_;
};

}  // namespace

Simplified simplify_checked(const Mesh& mesh, double tolerance, const SimplifyChecks& checks, const Context& context) {
  if (!(tolerance > 0 && std::isfinite(tolerance)))
    throw ParameterError(fmt::format("tolerance = {:g}, must be > 0", tolerance));
  check_editable(mesh, "simplifying", simplify_bytes(mesh.triangles.size()), context);
  if (mesh.triangles.empty() || !(mesh.box().longest() > 0)) return unchanged(mesh, tolerance);
  Simplification run(mesh, tolerance, checks);
  if (!(run.distance(tolerance) > 0)) return unchanged(mesh, tolerance);
  run.collapse(tolerance, part_of(context, 0, 0.8));
  return run.prove(tolerance, part_of(context, 0.8, 1));
}

Simplified simplify(const Mesh& mesh, double tolerance, const Context& context) {
  return simplify_checked(mesh, tolerance, {}, context);
}

Simplified simplify_to(const Mesh& mesh, size_t triangles, const std::vector<uint8_t>& fixed, const Context& context) {
  if (triangles < 1) throw ParameterError(fmt::format("triangles = {}, must be >= 1", triangles));
  check_editable(mesh, "simplifying", simplify_bytes(mesh.triangles.size()), context);
  if (mesh.triangles.size() <= triangles || !(mesh.box().longest() > 0)) return unchanged(mesh, 0);
  // Edges of the result are about so long; tolerances are parts of that.
  const double edge = std::sqrt(mesh.area() / static_cast<double>(triangles));
  constexpr double first = 1.0 / 256, largest_step = 2, smallest_step = 1.06;
  double tolerance = std::max(first * edge, 1e-9 * mesh.box().longest());
  std::optional<Simplification> run;
  for (;; context.check()) {
    // Its cells should not be small against the tolerance: then it begins anew, with larger ones.
    constexpr double many_cells = 2;
    if (!run || run->distance(tolerance) > many_cells) run.emplace(mesh, tolerance, SimplifyChecks{}).fix(fixed);
    if (run->distance(tolerance) > 0) run->collapse(tolerance, silenced(context));
    const double many = static_cast<double>(run->triangles()) / static_cast<double>(triangles);
    const bool last = tolerance > mesh.box().longest();
    context.progress().advance(std::min(0.9, 1 / many),
                               fmt::format("{} triangles at {:.3g}", run->triangles(), tolerance));
    if (many <= 1 || last) {
      Simplified result = run->prove(tolerance, silenced(context));
      if (result.mesh.triangles.size() <= triangles || last) return result;
    }
    tolerance *= std::clamp(many, smallest_step, largest_step);
  }
}

Simplified simplify_to(const Mesh& mesh, size_t triangles, const Context& context) {
  return simplify_to(mesh, triangles, {}, context);
}

}  // namespace soapfilm
