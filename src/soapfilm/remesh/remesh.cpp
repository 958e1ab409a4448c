// The page that reads aloud: from a mesh to one with even triangles.
#include "soapfilm/remesh/remesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/remesh/distance.h"
#include "soapfilm/remesh/rounds.h"
#include "soapfilm/simplify/carry_over.h"
#include "soapfilm/simplify/check_editable.h"
#include "soapfilm/simplify/thin_places.h"

namespace soapfilm {

namespace {

constexpr double degree = 3.14159265358979323846 / 180;

/// Of a run, measured: by the triangles of the mesh and of the result.
constexpr uint64_t remesh_bytes(uint64_t given, uint64_t expected) { return 400 * given + 1700 * expected; }

/// Triangles of the result, about.
double expected_triangles(const Mesh& mesh, double edge) { return mesh.area() / (0.433 * edge * edge); }

void check_params(const Mesh& mesh, const RemeshParams& params, const Context& context) {
  constexpr double most_triangles = 1e8;
  if (!(params.edge > 0 && std::isfinite(params.edge)))
    throw ParameterError(fmt::format("edge = {:g}, must be > 0", params.edge));
  if (params.tolerance && !(*params.tolerance > 0 && std::isfinite(*params.tolerance)))
    throw ParameterError(fmt::format("tolerance = {:g}, must be > 0", *params.tolerance));
  check_editable(mesh, "remeshing", remesh_bytes(mesh.triangles.size(), 0), context);
  const double expected = expected_triangles(mesh, params.edge);
  if (!(expected <= most_triangles))
    throw ParameterError(fmt::format("edge = {:g}: about {:.2g} triangles, must be at most {:g}", params.edge, expected,
                                     most_triangles));
  check_room(mesh, "remeshing to many of", remesh_bytes(mesh.triangles.size(), static_cast<uint64_t>(expected)),
             context);
}

class Remeshing {
 public:
  Remeshing(const Mesh& mesh, const RemeshParams& params, const Context& context)
      : given_(mesh),
        params_(params),
        context_(context),
        tolerance_(params.tolerance.value_or(0.5 * params.edge)),
        written_(mesh, std::min(tolerance_, 0.5 * params.edge), params.edge),
        now_(mesh, written_, params.edge / written_.unit()),
        grid_(now_.original, now_.was.all_corners()),
        thin_(now_, 0.5 * params.edge / written_.unit()),
        proof_(mesh, tolerance_),
        rounds_(now_, grid_, thin_, 0.5 * reach() / written_.unit(),
                Landmarks(now_.original, 0.25 * params.edge / written_.unit(), 0.8 * reach() / written_.unit()),
                context_) {}

  Remeshed run() {
    const double edge = params_.edge / written_.unit();
    now_.keep(
        find_features(now_.was, now_.original, Sides(now_.original, now_.was.all_corners(), edge, context_), edge));
    constexpr int rounds = 10, rounds_of_repair = 4, most_repairs = 12;
    context_.progress().detail(
        fmt::format("remesh: {} stretches of sharp edges and borders", now_.features.chains.size()));
    rounds_.begin();
    rounds_.improve(rounds);
    for (int repairs = 0;; ++repairs) {
      context_.check();
      const ProvedDistance proved = proof_.of(now_, context_);
      std::vector<uint32_t> bad = proved.beyond;
      const size_t meeting = add_meeting(bad);
      context_.progress().detail(fmt::format("remesh: within {:.3g}, {} vertices beyond, {} pairs intersect",
                                             proved.distance, proved.beyond.size(), meeting));
      if (bad.empty() || repairs == most_repairs) return finished(proved, meeting);
      refine(bad);
      rounds_.improve(rounds_of_repair);
    }
  }

 private:
  size_t add_meeting(std::vector<uint32_t>& vertices) const {
    const auto pairs = meeting_pairs(now_, std::vector<uint8_t>(now_.mesh.triangles(), 1), context_);
    for (const auto& pair : pairs)
      for (const uint32_t t : pair)
        for (const uint32_t v : now_.mesh.corners(t)) vertices.push_back(v);
    return pairs.size();
  }

  /// How far the surface may go while it is changed, input units.
  double reach() const { return std::min(tolerance_, 0.5 * params_.edge); }

  /// Shorter edges at vertices where something fails: by a little, so that they may still be even.
  void refine(std::vector<uint32_t> vertices) {
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    constexpr double shorter = 0.75;
    for (const uint32_t v : vertices) now_.size[v] *= shorter;
    now_.grade_sizes();
  }

  Remeshed finished(const ProvedDistance& proved, size_t meeting) const {
    if (params_.tolerance && !(proved.distance <= *params_.tolerance))
      throw ParameterError(fmt::format("tolerance = {:g}: only {:.3g} could be proved, must be larger",
                                       *params_.tolerance, proved.distance));
    Remeshed result;
    result.report.triangles_before = given_.triangles.size();
    result.report.proved = proved.distance;
    result.report.intersecting = meeting;
    fill(result.mesh);
    judge(result);
    return result;
  }

  void fill(Mesh& mesh) const {
    std::vector<uint32_t> number(now_.position.size(), WorkingMesh::none);
    std::vector<Blend> blends;
    for (uint32_t v = 0; v < number.size(); ++v) {
      if (!now_.mesh.is_used(v)) continue;
      number[v] = static_cast<uint32_t>(mesh.vertices.size());
      mesh.vertices.push_back(written_.world(now_.position[v]));
      blends.push_back(blend_of(v));
    }
    for (uint32_t t = 0; t < now_.mesh.triangles(); ++t) {
      if (!now_.mesh.is_alive(t)) continue;
      const Triangle& v = now_.mesh.corners(t);
      mesh.triangles.push_back({number[v[0]], number[v[1]], number[v[2]]});
    }
    append_blended(mesh, given_, blends);
  }

  Blend blend_of(uint32_t v) const {
    const Vec3d p = now_.position[v];
    for (double radius = 0.125; radius < 16; radius *= 2)
      if (const uint32_t f = grid_.nearest(p, radius); f != CellTable::none)
        return blend_at(p, now_.was.corners(f), grid_.corner(f, 0), grid_.corner(f, 1), grid_.corner(f, 2));
    return {{0, 0, 0}, {1, 0, 0}};
  }

  void judge(Remeshed& result) const {
    const double edge = params_.edge / written_.unit(), least = std::sin(20 * degree);
    size_t even = 0, edges = 0, good = 0, all = 0;
    double sharpest = 1;
    for (uint32_t h = 0; h < 3 * now_.mesh.triangles(); ++h) {
      if (!now_.mesh.is_alive(h / 3)) continue;
      if (now_.leads(h)) {
        ++edges;
        const double length = now_.length(h) / edge;
        even += length >= 0.7 && length <= 1.4;
      }
      if (h % 3 != 0) continue;
      ++all;
      const double sharp = squared_sharpness(now_.corners(h / 3));
      good += sharp >= least * least;
      sharpest = std::min(sharpest, sharp);
    }
    result.report.triangles = all;
    result.report.even_edges = static_cast<double>(even) / static_cast<double>(edges);
    result.report.good_angles = static_cast<double>(good) / static_cast<double>(all);
    result.report.smallest_angle = std::asin(std::sqrt(sharpest)) / degree;
  }

  const Mesh& given_;
  RemeshParams params_;
  const Context& context_;
  double tolerance_;
  Written written_;
  WorkingMesh now_;
  FaceGrid grid_;
  ThinPlaces thin_;
  DistanceProof proof_;
  Rounds rounds_;
};

}  // namespace

Remeshed remesh(const Mesh& mesh, const RemeshParams& params, const Context& context) {
  check_params(mesh, params, context);
  if (mesh.triangles.empty() || !(mesh.box().longest() > 0))
    throw ParameterError("mesh: it has no area, must have triangles");
  return Remeshing(mesh, params, context).run();
}

}  // namespace soapfilm
