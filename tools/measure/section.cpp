#include "tools/measure/section.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace soapfilm {

namespace {

using Edge = std::pair<uint32_t, uint32_t>;  // the smaller vertex first

/// A triangle's cut: it enters at one edge and leaves at the other.
struct Cut {
  Edge from, to;
};

Edge edge_between(uint32_t a, uint32_t b) { return std::minmax(a, b); }

std::vector<Cut> cuts_of(const Mesh& mesh, const std::vector<double>& height) {
  std::vector<Cut> cuts;
  for (const Triangle& t : mesh.triangles) {
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      const bool alone = (height[a] >= 0) != (height[b] >= 0) && (height[b] >= 0) == (height[c] >= 0);
      if (!alone) continue;
      // Counter-clockwise seen from outside: with its first corner above, the cut runs from the first side to the last.
      const Edge first = edge_between(a, b), last = edge_between(a, c);
      cuts.push_back(height[a] >= 0 ? Cut{first, last} : Cut{last, first});
    }
  }
  return cuts;
}

/// Finds the cut that goes on from an edge. Where several do (a mesh that is no manifold) each is taken once.
class NextCut {
 public:
  explicit NextCut(const std::vector<Cut>& cuts) {
    for (size_t i = 0; i < cuts.size(); ++i) from_.emplace_back(cuts[i].from, i);
    std::sort(from_.begin(), from_.end());
    taken_.resize(cuts.size());
  }

  bool take(size_t cut) { return std::exchange(taken_[cut], uint8_t{1}) == 0; }

  /// The number of cuts if there is none.
  size_t after(const Edge& edge) {
    auto next = std::lower_bound(from_.begin(), from_.end(), std::pair(edge, size_t{0}));
    while (next != from_.end() && next->first == edge && taken_[next->second] != 0) ++next;
    return next != from_.end() && next->first == edge ? next->second : from_.size();
  }

 private:
  std::vector<std::pair<Edge, size_t>> from_;
  std::vector<uint8_t> taken_;
};

/// Cuts at which a contour begins: those that no other leads to come first, or a line would begin in its middle.
std::vector<size_t> starts_of(const std::vector<Cut>& cuts) {
  std::vector<Edge> ends;
  for (const Cut& cut : cuts) ends.push_back(cut.to);
  std::sort(ends.begin(), ends.end());
  std::vector<size_t> starts(cuts.size());
  for (size_t i = 0; i < starts.size(); ++i) starts[i] = i;
  std::stable_partition(starts.begin(), starts.end(),
                        [&](size_t i) { return !std::binary_search(ends.begin(), ends.end(), cuts[i].from); });
  return starts;
}

}  // namespace

double Section::length() const {
  double sum = 0;
  for (const Contour& contour : contours)
    for (size_t i = contour.closed ? 0 : 1; i < contour.points.size(); ++i)
      sum += norm(contour.points[i] - contour.points[i == 0 ? contour.points.size() - 1 : i - 1]);
  return sum;
}

double Section::area() const {
  double twice = 0;
  for (const Contour& contour : contours) {
    if (!contour.closed) continue;
    const Vec3d origin = contour.points[0];
    for (size_t i = 2; i < contour.points.size(); ++i)
      twice += dot(plane.normal, cross(contour.points[i - 1] - origin, contour.points[i] - origin));
  }
  return 0.5 * twice;
}

bool Section::closed() const {
  return std::all_of(contours.begin(), contours.end(), [](const Contour& contour) { return contour.closed; });
}

Section section(const Mesh& mesh, const Plane& plane) {
  std::vector<double> height;
  for (const Vec3d& v : mesh.vertices) height.push_back(plane.height(v));
  const auto point = [&](const Edge& edge) {
    const Vec3d a = mesh.vertices[edge.first], b = mesh.vertices[edge.second];
    return a + (b - a) * (height[edge.first] / (height[edge.first] - height[edge.second]));
  };
  const std::vector<Cut> cuts = cuts_of(mesh, height);
  NextCut next(cuts);
  Section out{plane, {}};
  for (const size_t start : starts_of(cuts)) {
    if (!next.take(start)) continue;
    Contour contour;
    // Around a vertex on the plane several cuts have the same end.
    const auto add = [&](Vec3d p) {
      if (contour.points.empty() || contour.points.back() != p) contour.points.push_back(p);
    };
    add(point(cuts[start].from));
    Edge end = cuts[start].to;
    for (size_t cut = next.after(end); cut < cuts.size(); cut = next.after(end)) {
      next.take(cut);
      add(point(end));
      end = cuts[cut].to;
    }
    contour.closed = end == cuts[start].from;
    if (!contour.closed) add(point(end));
    while (contour.closed && contour.points.size() > 1 && contour.points.back() == contour.points[0])
      contour.points.pop_back();
    const size_t least = contour.closed ? 3 : 2;  // a tip that touches the plane encloses nothing
    if (contour.points.size() >= least) out.contours.push_back(std::move(contour));
  }
  return out;
}

PlaneAxes axes_of(const Plane& plane) {
  const Vec3d across = cross(Vec3d{0, 0, 1}, plane.normal);
  const Vec3d right = norm(across) > 1e-9 ? normalized(across) : Vec3d{1, 0, 0};
  return {right, cross(plane.normal, right)};
}

}  // namespace soapfilm
