#include "soapfilm/remesh/distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/triangle_distance.h"
#include "soapfilm/simplify/face_grid.h"
#include "soapfilm/simplify/near_original.h"

namespace soapfilm {

namespace {

constexpr size_t triangles_per_task = 256;
constexpr double infinite = std::numeric_limits<double>::infinity();

/// The distance within which a triangle is of a surface: tried from small to large, in the surface's local frame.
double least_proved(NearOriginal& near, const std::array<Vec3d, 3>& triangle, double tolerance) {
  constexpr double first = 1.0 / 64, step = 2, last = 4;
  for (double share = first; share <= last; share *= step) {
    double most = 0;
    if (near.holds(triangle, share * tolerance, most)) return most;
  }
  return infinite;
}

/// Of triangles of the mean area.
double mean_edge(const Mesh& mesh) { return 1.5 * std::sqrt(mesh.area() / static_cast<double>(mesh.triangles.size())); }

using Corners = std::array<Vec3d, 3>;

/// The distance of a border edge and its stretch of the old border. What is farthest from the edge is a vertex of the
/// stretch. The reverse: the stretch's projection onto the edge is connected, and what it leaves out at the edge's ends
/// is no farther from the stretch's ends than the edge's ends are.
double squared_border_distance(const WorkingMesh& now, uint32_t h) {
  const uint32_t number = now.chain_of_edge[h];
  const Chain& chain = now.features.chains[number];
  double from = now.along(number, now.mesh.from(h)), to = now.along(number, now.mesh.to(h));
  Vec3d a = now.from(h), b = now.to(h);
  if (from > to) {
    std::swap(from, to);
    std::swap(a, b);
  }
  const Vec3d off_from = chain.place(from) - a, off_to = chain.place(to) - b;
  double most = std::max(dot(off_from, off_from), dot(off_to, off_to));
  for (auto i = static_cast<size_t>(std::lower_bound(chain.at.begin(), chain.at.end(), from) - chain.at.begin());
       i < chain.at.size() && chain.at[i] <= to; ++i)
    most = std::max(most, squared_distance(chain.point[i], a, b, b));
  return most;
}

/// Collects what is too far.
class Verdict {
 public:
  Verdict(double tolerance, size_t vertices) : tolerance_(tolerance), is_beyond_(vertices) {}

  /// Input units. Where it is too far, `vertices` of the new mesh are remembered.
  template <class Vertices>
  void take(double distance, const Vertices& vertices) {
    most_ = std::max(most_, distance);
    if (!(distance <= tolerance_))
      for (const uint32_t v : vertices) is_beyond_[v] = 1;
  }
  bool is_far(double distance) const { return !(distance <= tolerance_); }
  void take(double distance) { most_ = std::max(most_, distance); }

  ProvedDistance result() const {
    ProvedDistance found{most_, {}};
    for (uint32_t v = 0; v < is_beyond_.size(); ++v)
      if (is_beyond_[v]) found.beyond.push_back(v);
    return found;
  }

 private:
  double tolerance_;
  std::vector<uint8_t> is_beyond_;  // by vertex
  double most_ = 0;
};

/// The triangles that are there, and the number of each of their vertices.
struct NewMesh {
  Mesh mesh;  ///< input units
  std::vector<uint32_t> vertex, triangle;

  explicit NewMesh(const WorkingMesh& now) {
    std::vector<uint32_t> number(now.position.size(), WorkingMesh::none);
    for (uint32_t t = 0; t < now.mesh.triangles(); ++t) {
      if (!now.mesh.is_alive(t)) continue;
      Triangle corners = now.mesh.corners(t);
      for (uint32_t& v : corners) {
        if (number[v] == WorkingMesh::none) {
          number[v] = static_cast<uint32_t>(vertex.size());
          vertex.push_back(v);
          mesh.vertices.push_back(now.written.world(now.position[v]));
        }
        v = number[v];
      }
      mesh.triangles.push_back(corners);
      triangle.push_back(t);
    }
  }
};

}  // namespace

/// A mesh that triangles are compared with, in a frame of its own. Its unit, the side of the cells that are searched,
/// is about the length of its edges, but not small against the distances.
struct DistanceProof::Surface {
  static constexpr double exact = 1e-300;  // no tolerance for rounding: doubles stay doubles

  Surface(const Mesh& mesh, double tolerance)
      : written(mesh, exact, std::max(0.25 * tolerance, mean_edge(mesh))),
        edited(mesh, written),
        grid(edited.original, edited.was.all_corners()) {}

  /// By triangle of the other mesh, input units.
  std::vector<double> distances(const Mesh& other, double tolerance, const Context& context) const {
    std::vector<Vec3d> place(other.vertices.size());
    double moved = 0;
    for (size_t v = 0; v < place.size(); ++v) {
      place[v] = written.local(other.vertices[v]);
      moved = std::max(moved, norm(other.vertices[v] - written.world(place[v])));
    }
    std::vector<double> distance(other.triangles.size());
    parallel_chunks(context, distance.size(), triangles_per_task, [&](size_t begin, size_t end) {
      NearOriginal near(edited, grid);
      for (size_t i = begin; i < end; ++i) {
        const Triangle& v = other.triangles[i];
        const Corners corners{place[v[0]], place[v[1]], place[v[2]]};
        distance[i] = least_proved(near, corners, tolerance / written.unit()) * written.unit() + moved +
                      written.moved() + written.slack();
      }
    });
    return distance;
  }

  Written written;
  EditedMesh edited;
  FaceGrid grid;
};

DistanceProof::DistanceProof(const Mesh& original, double tolerance)
    : given_(original), tolerance_(tolerance), original_(std::make_unique<Surface>(original, tolerance)) {}

DistanceProof::~DistanceProof() = default;

ProvedDistance DistanceProof::of(const WorkingMesh& now, const Context& context) const {
  Verdict verdict(tolerance_, now.position.size());
  const NewMesh result(now);
  const std::vector<double> to_old = original_->distances(result.mesh, tolerance_, context);
  for (size_t i = 0; i < to_old.size(); ++i) verdict.take(to_old[i], now.mesh.corners(result.triangle[i]));

  for (const uint32_t t : result.triangle)
    for (uint32_t h = 3 * t; h < 3 * t + 3; ++h)
      if (now.mesh.twin(h) == WorkingMesh::none)
        verdict.take(
            std::sqrt(squared_border_distance(now, h)) * now.written.unit() + now.written.moved() + now.written.slack(),
            std::array{now.mesh.from(h), now.mesh.to(h)});

  const Surface surface(result.mesh, tolerance_);
  const std::vector<double> to_new = surface.distances(given_, tolerance_, context);
  for (size_t f = 0; f < to_new.size(); ++f) {
    verdict.take(to_new[f]);
    if (!verdict.is_far(to_new[f])) continue;
    const Triangle& v = given_.triangles[f];
    const Vec3d middle = (given_.vertices[v[0]] + given_.vertices[v[1]] + given_.vertices[v[2]]) / 3.0;
    const uint32_t near = surface.grid.nearest(surface.written.local(middle), 16 * tolerance_ / surface.written.unit());
    if (near == CellTable::none) continue;
    for (const uint32_t k : surface.edited.was.corners(near)) verdict.take(to_new[f], std::array{result.vertex[k]});
  }
  return verdict.result();
}

}  // namespace soapfilm
