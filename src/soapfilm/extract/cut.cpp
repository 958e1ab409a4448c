#include "soapfilm/extract/cut.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "soapfilm/core/disjoint_sets.h"

namespace soapfilm {

namespace {

constexpr uint32_t none = ~uint32_t{0};

/// Gives each fan of triangles around a vertex a vertex of its own: corners of triangles that share an edge are one
/// fan.
class Fans {
 public:
  explicit Fans(Mesh& mesh) : mesh_(mesh), fans_(3 * mesh.triangles.size()) { join_across_edges(); }

  void separate() {
    const std::vector<Vec3d> places = std::move(mesh_.vertices);
    mesh_.vertices.clear();
    std::vector<uint32_t> vertex(fans_.size(), none);
    for (uint32_t corner = 0; corner < fans_.size(); ++corner) {
      const uint32_t fan = fans_.root(corner);
      uint32_t& v = mesh_.triangles[corner / 3][corner % 3];
      if (vertex[fan] == none) {
        vertex[fan] = static_cast<uint32_t>(mesh_.vertices.size());
        mesh_.vertices.push_back(places[v]);
      }
      v = vertex[fan];
    }
  }

 private:
  void join_across_edges() {
    struct Half {
      uint32_t low, high, corner;
    };
    std::vector<Half> halves(fans_.size());
    const auto next = [](uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; };
    const auto at = [&](uint32_t h) { return mesh_.triangles[h / 3][h % 3]; };
    for (uint32_t h = 0; h < halves.size(); ++h)
      halves[h] = {std::min(at(h), at(next(h))), std::max(at(h), at(next(h))), h};
    std::sort(halves.begin(), halves.end(), [](const Half& a, const Half& b) {
      return std::array{a.low, a.high, a.corner} < std::array{b.low, b.high, b.corner};
    });
    for (size_t i = 1; i < halves.size(); ++i) {
      if (halves[i].low != halves[i - 1].low || halves[i].high != halves[i - 1].high) continue;
      const uint32_t a = halves[i - 1].corner, b = halves[i].corner;
      fans_.join(a, next(b));
      fans_.join(b, next(a));
    }
  }

  Mesh& mesh_;
  DisjointSets fans_;
};

}  // namespace

void keep_triangles(Mesh& mesh, const std::function<bool(uint32_t)>& wanted) {
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return !(wanted(t[0]) && wanted(t[1]) && wanted(t[2])); });
  mesh.normals.clear();
  mesh.colors.clear();
  mesh.attributes.clear();
  Fans(mesh).separate();
}

}  // namespace soapfilm
