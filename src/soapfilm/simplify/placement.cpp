#include "soapfilm/simplify/placement.h"

#include <algorithm>

namespace soapfilm {

namespace {

constexpr double pull = 1e-3;   // towards the edge's middle, where planes leave a direction free
constexpr double farthest = 2;  // from the middle, lengths of the edge
constexpr double length_price = 1e-5;
constexpr double least_turn = 0.05;  // of the star's vector area over its area: below it the volume says nothing

/// The best of the places that need no equation.
Vec3d best_on_edge(const Quadric& sum, Vec3d a, Vec3d b) {
  const Vec3d middle = (a + b) * 0.5;
  const Vec3d end = sum.at(a) <= sum.at(b) ? a : b;
  return sum.at(middle) <= sum.at(end) ? middle : end;
}

}  // namespace

double collapse_cost(const Quadric& sum, Vec3d a, Vec3d b) {
  const Vec3d middle = (a + b) * 0.5, along = b - a;
  const double length2 = dot(along, along);
  double least = sum.at(middle);
  if (const auto inverse = sum.matrix(pull).inverse()) {
    const Vec3d move = *inverse * -sum.slope(middle);
    if (dot(move, move) <= farthest * farthest * length2)
      least = sum.at(middle + move) + length_price * dot(move, move);
  }
  return least + length_price * length2;
}

Vec3d place_keeping_volume(const Quadric& sum, Vec3d a, Vec3d b, std::span<const StarCorners> star) {
  const Vec3d middle = (a + b) * 0.5, along = b - a;
  const auto inverse = sum.matrix(pull).inverse();
  // Six times the volume between the star and the middle's fan over the same rim; twice the star's vector area.
  Vec3d turn;
  double volume = 0, area = 0;
  for (const StarCorners& t : star) {
    const Vec3d n = cross(t.b - t.a, t.c - t.a);
    turn += n;
    area += norm(n);
    volume += dot(n, t.a - middle);
  }
  const bool constrained = norm(turn) > least_turn * area;
  const auto keep_volume = [&](Vec3d move, Vec3d freely) {
    const double change = dot(turn, freely);
    return change != 0 ? move + freely * ((volume - dot(turn, move)) / change) : move;
  };
  const double limit = farthest * farthest * dot(along, along);
  if (inverse) {
    Vec3d move = *inverse * -sum.slope(middle);
    if (constrained) move = keep_volume(move, *inverse * turn);
    if (dot(move, move) <= limit) return middle + move;
  }
  const Vec3d best = best_on_edge(sum, a, b) - middle;
  const Vec3d kept = constrained ? keep_volume(best, turn) : best;
  return middle + (dot(kept, kept) <= limit ? kept : best);
}

}  // namespace soapfilm
