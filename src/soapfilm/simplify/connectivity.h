// Which triangles are neighbors while edges collapse, and how to take a collapse back.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "soapfilm/mesh.h"

namespace soapfilm {

/// The triangles of a manifold with or without border. Half edge 3 t + k runs from corner k of triangle t to the next
/// corner; its twin runs back in the neighbor. Triangles keep their numbers; those that a collapse removes keep their
/// corners and twins, by which it is undone.
class Connectivity {
 public:
  static constexpr uint32_t none = ~uint32_t{0};

  /// Throws ParameterError, with the edge or vertex, where the triangles are not an oriented 2-manifold.
  Connectivity(std::vector<Triangle> triangles, size_t vertices);

  size_t triangles() const { return corner_.size(); }
  const std::vector<Triangle>& all_corners() const { return corner_; }
  const Triangle& corners(uint32_t triangle) const { return corner_[triangle]; }
  bool is_alive(uint32_t triangle) const { return alive_[triangle] != 0; }
  static uint32_t next(uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static uint32_t previous(uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  uint32_t twin(uint32_t h) const { return twin_[h]; }
  uint32_t from(uint32_t h) const { return corner_[h / 3][h % 3]; }
  uint32_t to(uint32_t h) const { return from(next(h)); }

  bool is_used(uint32_t vertex) const { return first_[vertex] != none; }
  bool on_border(uint32_t vertex) const { return twin_[first_[vertex]] == none; }
  /// The half edges that leave the vertex, counter-clockwise; at a border the first one is of the border.
  template <class Visit>
  void for_fan(uint32_t vertex, Visit&& visit) const {
    const uint32_t begin = first_[vertex];
    uint32_t h = begin;
    do {
      visit(h);
      h = twin_[previous(h)];
    } while (h != begin && h != none);
  }
  /// The border vertex before: the border runs from there to `vertex`.
  uint32_t before_on_border(uint32_t vertex) const;
  uint32_t after_on_border(uint32_t vertex) const { return to(first_[vertex]); }

  /// Collapses the edge of h into its end `kept`: its one or two triangles disappear, those of the other end get the
  /// corner `kept`. The link condition must hold.
  void collapse(uint32_t h, uint32_t kept);
  /// Turns the edge of two triangles around in their quadrilateral. The other diagonal must be no edge yet.
  void flip(uint32_t h);
  /// A new vertex on the edge of h, whose one or two triangles are halved. Returns it. The triangles keep their
  /// numbers; their half edges are others.
  uint32_t split(uint32_t h);
  /// Takes back the collapse of h, whose neighborhood must be as after it.
  void undo(uint32_t h, uint32_t kept);

 private:
  void find_twins();
  void check_fans() const;
  void link(uint32_t h, uint32_t other) {
    if (h != none) twin_[h] = other;
    if (other != none) twin_[other] = h;
  }
  /// The clockwise-most half edge of the fan of h at a border, else h.
  uint32_t rewound(uint32_t h) const;
  uint32_t add_triangle();
  /// Gives a triangle its corners, and half edges k their twins.
  void set(uint32_t triangle, const Triangle& corners, const std::array<uint32_t, 3>& twins);
  void relabel(uint32_t h, uint32_t vertex);

  std::vector<Triangle> corner_;
  std::vector<uint32_t> twin_;   // by half edge
  std::vector<uint32_t> first_;  // by vertex
  std::vector<uint8_t> alive_;   // by triangle
};

}  // namespace soapfilm
