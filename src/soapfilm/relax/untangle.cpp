#include "soapfilm/relax/untangle.h"

#include <algorithm>
#include <cmath>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/share.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/relax/crossings.h"

namespace soapfilm {

namespace {

constexpr double least_cosine = 0.4;  // between a triangle's normals before and after its corners move
constexpr int most_halvings = 3;      // of a move; then it is undone
constexpr size_t triangles_per_task = 1 << 14;

void make_unique(std::vector<uint32_t>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

class Moves {
 public:
  Moves(Mesh& mesh, std::span<const Vec3d> start, double voxel, const Context& context)
      : mesh_(mesh),
        start_(start),
        target_(mesh.vertices),
        context_(context),
        halvings_(start.size()),
        may_fold_(mesh.triangles.size(), 1),
        may_cross_(mesh.triangles.size(), 1),
        search_({mesh.triangles, mesh.triangles, start_, target_, may_cross_}, voxel, context) {}

  void run() {
    for (;;) {
      unfold();
      std::vector<uint32_t> corners;
      for (const auto& pair : search_.find(mesh_.vertices, may_cross_))
        for (const uint32_t t : pair)
          corners.insert(corners.end(), mesh_.triangles[t].begin(), mesh_.triangles[t].end());
      std::fill(may_cross_.begin(), may_cross_.end(), uint8_t{0});
      if (corners.empty()) return;
      halve(corners);
    }
  }

 private:
  void unfold() {
    for (;;) {
      std::vector<uint32_t> corners = folded_corners();
      std::fill(may_fold_.begin(), may_fold_.end(), uint8_t{0});
      if (corners.empty()) return;
      halve(corners);
    }
  }

  std::vector<uint32_t> folded_corners() const {
    const auto normal_of = [](std::span<const Vec3d> at, const Triangle& t) {
      return normalized(cross(at[t[1]] - at[t[0]], at[t[2]] - at[t[0]]));
    };
    return share_gather<uint32_t>(
        mesh_.triangles.size(), triangles_per_task, context_, [&](size_t i, std::vector<uint32_t>& found) {
          const Triangle& t = mesh_.triangles[i];
          if (!may_fold_[i] || dot(normal_of(start_, t), normal_of(mesh_.vertices, t)) > least_cosine) return;
          found.insert(found.end(), t.begin(), t.end());
        });
  }

  void halve(std::vector<uint32_t>& corners) {
    make_unique(corners);
    std::vector<uint8_t> changed(start_.size());
    for (const uint32_t v : corners) {
      if (mesh_.vertices[v] == start_[v]) continue;
      changed[v] = 1;
      mesh_.vertices[v] = ++halvings_[v] < most_halvings
                              ? start_[v] + (target_[v] - start_[v]) * std::ldexp(1.0, -halvings_[v])
                              : start_[v];
    }
    parallel_for(context_, mesh_.triangles.size(), triangles_per_task, [&](size_t i) {
      const auto [a, b, c] = mesh_.triangles[i];
      if (changed[a] || changed[b] || changed[c]) may_fold_[i] = may_cross_[i] = 1;
    });
  }

  Mesh& mesh_;
  std::span<const Vec3d> start_;
  const std::vector<Vec3d> target_;
  const Context& context_;
  std::vector<uint8_t> halvings_;              // by vertex
  std::vector<uint8_t> may_fold_, may_cross_;  // by triangle: changed since the last check
  const CrossingSearch search_;
};

}  // namespace

void untangle(Mesh& mesh, std::span<const Vec3d> start, double voxel, const Context& context) {
  Moves(mesh, start, voxel, context).run();
}

}  // namespace soapfilm
