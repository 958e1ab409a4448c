#include "soapfilm/remesh/sides.h"

#include <algorithm>
#include <cmath>

#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

constexpr size_t faces_per_task = 256;
constexpr double reach = 0.6;            // of an edge
constexpr double kernel_cosine = 0.35;   // of 70 degrees: normals farther apart do not count
constexpr double rounded_cosine = 0.94;  // of 20 degrees
constexpr double bend_cosine = 0.94;     // from the mean of a place
constexpr double most_sharpened = 0.35;  // of an edge
constexpr double cells_per_edge = 4;

/// visit(cell, share) for the cells that it lies in, each with the same share of it.
template <class Visit>
void for_cells_of(const std::vector<Vec3d>& vertices, const Triangle& face, double per_side, Visit&& visit) {
  const Vec3d a = vertices[face[0]], b = vertices[face[1]], c = vertices[face[2]];
  size_t count = 0;
  for_cells(a, b, c, 0, per_side, [&](Vec3i) { ++count; });
  const double share = 1 / static_cast<double>(count);
  for_cells(a, b, c, 0, per_side, [&](Vec3i cell) { visit(cell, share); });
}

/// One of 27, of normals that look about the same way.
int bin_of(Vec3d normal) {
  const auto third = [](double v) { return v < -1.0 / 3 ? 0 : v > 1.0 / 3 ? 2 : 1; };
  return 9 * third(normal.x) + 3 * third(normal.y) + third(normal.z);
}

}  // namespace

Sides::Sides(const std::vector<Vec3d>& vertices, const std::vector<Triangle>& faces, double edge,
             const Context& context)
    : edge_(edge), radius_(reach * edge), per_side_(cells_per_edge / edge) {
  for (const Triangle& t : faces) {
    const Vec3d a = vertices[t[0]], b = vertices[t[1]], c = vertices[t[2]], n = cross(b - a, c - a);
    own_.push_back(normalized(n));
    area_.push_back(0.5 * norm(n));
    center_.push_back((a + b + c) / 3.0);
  }
  side_ = own_;
  add_patches(vertices, faces);
  const std::vector<uint8_t> bent = faces_at_bends();
  parallel_for(context, faces.size(), faces_per_task, [&](size_t f) {
    if (bent[f]) side_[f] = mode_at(static_cast<uint32_t>(f));
  });
  planes_.resize(cells_.size());
  for (uint32_t f = 0; f < faces.size(); ++f)
    if (area_[f] > 0 && !is_rounded(f))
      for_cells_of(vertices, faces[f], per_side_, [&](Vec3i cell, double share) {
        planes_[cells_.find(cell_key(cell))].add_plane(own_[f], center_[f], share * area_[f]);
      });
}

void Sides::add_patches(const std::vector<Vec3d>& vertices, const std::vector<Triangle>& faces) {
  for (uint32_t f = 0; f < faces.size(); ++f)
    for_cells_of(vertices, faces[f], per_side_, [&](Vec3i cell, double share) {
      const uint32_t number = cells_.insert(cell_key(cell));
      if (number == patches_.size()) patches_.emplace_back();
      std::vector<Patch>& there = patches_[number];
      const int bin = bin_of(own_[f]);
      auto patch = std::find_if(there.begin(), there.end(), [&](const Patch& p) { return p.bin == bin; });
      if (patch == there.end()) patch = there.insert(there.end(), {bin, {}, 0});
      patch->normal += own_[f] * (share * area_[f]);
      patch->area += share * area_[f];
    });
}

bool Sides::is_rounded(uint32_t face) const { return dot(own_[face], side_[face]) < rounded_cosine; }

template <class Visit>
void Sides::for_cells_near(Vec3d p, Visit&& visit) const {
  const Vec3d r{radius_, radius_, radius_};
  const Vec3i lo = cell_of(p - r, per_side_), hi = cell_of(p + r, per_side_);
  for (int z = lo.z; z <= hi.z; ++z)
    for (int y = lo.y; y <= hi.y; ++y)
      for (int x = lo.x; x <= hi.x; ++x) {
        const Vec3d middle = Vec3d{x + 0.5, y + 0.5, z + 0.5} / per_side_ - p;
        if (dot(middle, middle) > radius_ * radius_) continue;
        if (const uint32_t cell = cells_.find(cell_key({x, y, z})); cell != CellTable::none) visit(cell);
      }
}

/// Their normals are unit.
std::vector<Sides::Patch> Sides::patches_near(Vec3d p) const {
  std::vector<Patch> near;
  for_cells_near(p, [&](uint32_t cell) { near.insert(near.end(), patches_[cell].begin(), patches_[cell].end()); });
  for (Patch& patch : near) patch.normal = normalized(patch.normal);
  return near;
}

/// In cells where some face looks another way than most, and beside those.
std::vector<uint8_t> Sides::faces_at_bends() const {
  const double per_side = 1 / edge_;
  CellTable cells;
  std::vector<Vec3d> sum;
  std::vector<uint32_t> cell(own_.size());
  std::vector<Vec3i> place;
  for (uint32_t f = 0; f < own_.size(); ++f) {
    const Vec3i at = cell_of(center_[f], per_side);
    cell[f] = cells.insert(cell_key(at));
    if (cell[f] == sum.size()) {
      sum.push_back({});
      place.push_back(at);
    }
    sum[cell[f]] += own_[f] * area_[f];
  }
  std::vector<uint8_t> is_bend(sum.size()), near_bend(sum.size());
  for (uint32_t f = 0; f < own_.size(); ++f)
    if (dot(own_[f], normalized(sum[cell[f]])) < bend_cosine) is_bend[cell[f]] = 1;
  const auto for_around = [&](Vec3i at, auto&& visit) {
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x)
          if (const uint32_t c = cells.find(cell_key(at + Vec3i{x, y, z})); c != CellTable::none) visit(c);
  };
  // Two cells that look different ways are a bend too.
  for (uint32_t c = 0; c < sum.size(); ++c)
    for_around(place[c], [&](uint32_t d) {
      if (is_bend[d] || dot(normalized(sum[c]), normalized(sum[d])) < bend_cosine) near_bend[c] = 1;
    });
  std::vector<uint8_t> found(own_.size());
  for (uint32_t f = 0; f < own_.size(); ++f) found[f] = near_bend[cell[f]];
  return found;
}

/// The mean of the normals around, from the face's own on, weighed by how near they are to the mean of before.
Vec3d Sides::mode_at(uint32_t face) const {
  constexpr int most_steps = 40;
  constexpr double least_part = 0.1;  // of what is near: else the normal is that of a sliver
  const std::vector<Patch> near = patches_near(center_[face]);
  double all = 0;
  Vec3d mean;
  for (const Patch& patch : near) {
    all += patch.area;
    mean += patch.normal * patch.area;
  }
  Vec3d mode = own_[face];
  for (int step = 0; step < most_steps; ++step) {
    Vec3d sum;
    double part = 0;
    for (const Patch& patch : near) {
      const double by = dot(patch.normal, mode) - kernel_cosine;
      if (by <= 0) continue;
      sum += patch.normal * (patch.area * by * by);
      part += patch.area;
    }
    if (!(all > 0)) break;
    const bool is_sliver = step == 0 && part < least_part * all;
    const Vec3d next = normalized(is_sliver ? mean : sum);
    const bool settled = dot(next, mode) > 1 - 1e-11;
    mode = next;
    if (settled) break;
  }
  return mode;
}

Vec3d Sides::sharpened(Vec3d p) const {
  constexpr double pull = 1e-3;  // towards p, along the edge
  Quadric planes;
  for_cells_near(p, [&](uint32_t cell) { planes += planes_[cell]; });
  const auto inverse = planes.matrix(pull * planes.weight()).inverse();
  if (!inverse) return p;
  const Vec3d step = -(*inverse * planes.slope(p));
  const double length = norm(step), most = most_sharpened * edge_;
  return p + (length > most ? step * (most / length) : step);
}

}  // namespace soapfilm
