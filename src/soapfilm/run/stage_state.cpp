#include "soapfilm/run/stage_state.h"

#include <optional>
#include <utility>
#include <variant>

#include "soapfilm/core/context_state.h"
#include "soapfilm/grid/slabs.h"

namespace soapfilm {

namespace {

void put_text(std::ostream& to, const std::string& text) {
  put(to, uint64_t{text.size()});
  put(to, text.data(), text.size());
}

std::string get_text(std::istream& from) {
  uint64_t size = 0;
  get(from, size);
  std::string text(static_cast<size_t>(size), '\0');
  get(from, text.data(), text.size());
  return text;
}

void put_texts(std::ostream& to, const std::vector<std::string>& texts) {
  put(to, uint64_t{texts.size()});
  for (const std::string& text : texts) put_text(to, text);
}

std::vector<std::string> get_texts(std::istream& from) {
  uint64_t count = 0;
  get(from, count);
  std::vector<std::string> texts(static_cast<size_t>(count));
  for (std::string& text : texts) text = get_text(from);
  return texts;
}

/// The numbers of a report of directions, in one order: visit(number).
template <class Report, class Visit>
void numbers_of(Report& report, Visit&& visit) {
  visit(report.from_normals);
  visit(report.from_sensor);
  visit(report.from_scan);
  visit(report.from_planes);
  visit(report.far_planes);
  visit(report.without_plane);
  visit(report.estimated);
  visit(report.inward);
  visit(report.without_direction);
  visit(report.contradicting);
  visit(report.reoriented);
}

/// The columns of what lies around the samples, and its numbers.
template <class Surface, class Visit>
void parts_of(Surface& surface, Visit&& visit) {
  visit(surface.area);
  visit(surface.spacing);
  visit(surface.normal);
  visit(surface.line);
  visit(surface.planes);
  visit(surface.coverage);
  visit(surface.sides);
}

void put_grid(std::ostream& to, const BrickGrid& grid) {
  put(to, grid.bricks());
  put(to, uint64_t{grid.size()});
  for (size_t b = 0; b < grid.size(); ++b) put(to, grid.coord(b));
}

BrickMask get_bricks(std::istream& from) {
  Vec3i box;
  uint64_t count = 0;
  get(from, box);
  get(from, count);
  BrickMask bricks(box);
  for (uint64_t b = 0; b < count; ++b) {
    Vec3i brick;
    get(from, brick);
    bricks.set(brick);
  }
  return bricks;
}

template <class Values>
void put_values(std::ostream& to, const Values& values, ItemRange bricks) {
  put(to, values.brick(bricks.begin), bricks.size() * Values::values_per_brick);
}
template <class Values>
void get_values(std::istream& from, Values& values, ItemRange bricks) {
  get(from, values.brick(bricks.begin), bricks.size() * Values::values_per_brick);
}

void put_sides(std::ostream& to, const GapSides& sides, const BrickGrid& grid) {
  std::vector<uint8_t> inside(grid.gaps());
  for (size_t gap = 0; gap < inside.size(); ++gap) inside[gap] = sides[gap];
  put(to, inside);
}

GapSides get_sides(std::istream& from, const BrickGrid& grid) {
  std::vector<uint8_t> inside;
  get(from, inside);
  GapSides sides(grid);
  for (size_t gap = 0; gap < inside.size(); ++gap) sides.set(gap, inside[gap] != 0);
  return sides;
}

}  // namespace

void put_directions(std::ostream& to, const Orientation& found) {
  put(to, found.directions);
  put(to, found.views);
  parts_of(found.surface, [&](const auto& part) { put(to, part); });
  numbers_of(found.report, [&](const auto& number) { put(to, number); });
  put_text(to, found.report.assumed);
  put_texts(to, found.report.warnings);
}

Orientation get_directions(std::istream& from) {
  Orientation found;
  get(from, found.directions);
  get(from, found.views);
  parts_of(found.surface, [&](auto& part) { get(from, part); });
  numbers_of(found.report, [&](auto& number) { get(from, number); });
  found.report.assumed = get_text(from);
  found.report.warnings = get_texts(from);
  return found;
}

void put_level(std::ostream& to, const Level& level, const LevelReport& report) {
  put(to, report);
  put(to, level.lambda);
  put_grid(to, level.grid);
  put_sides(to, level.inside, level.grid);
  put(to, level.outside);
  put(to, level.slabs != nullptr);
  const ItemRange bricks = bricks_at_hand(level);
  put_values(to, level.u, bricks);
  put_values(to, level.p, bricks);
  const ItemRange planes = level.rim.planes(bricks);
  put(to, level.rim.flux().data() + planes.begin * brick_area, planes.size() * brick_area);
}

Level get_level(std::istream& from, const MakeLevel& make, LevelReport& report, const Context& context) {
  float lambda = 0;
  bool in_slabs = false;
  get(from, report);
  get(from, lambda);
  Level level = make(get_bricks(from));
  level.lambda = lambda;
  level.inside = get_sides(from, level.grid);
  get(from, level.outside);
  get(from, in_slabs);
  if (in_slabs) level.slabs = Slabs::of(level.grid, context);
  const ItemRange bricks = bricks_at_hand(level);
  get_values(from, level.u, bricks);
  get_values(from, level.p, bricks);
  const ItemRange planes = level.rim.planes(bricks);
  get(from, level.rim.flux().data() + planes.begin * brick_area, planes.size() * brick_area);
  return level;
}

void put_surface(std::ostream& to, const Surface& surface) {
  const SurfaceField& field = surface.values();
  put(to, std::holds_alternative<DistanceField>(surface.field));
  put(to, surface.isovalue);
  put(to, surface.scale);
  put(to, surface.refine.has_value());
  if (surface.refine) put(to, *surface.refine);
  put_grid(to, field.grid);
  put_sides(to, field.inside, field.grid);
  put_values(to, field.value, {0, field.grid.size()});
}

Surface get_surface(std::istream& from, const Context& context) {
  Surface surface;
  bool is_distance = false, refined = false;
  get(from, is_distance);
  get(from, surface.isovalue);
  get(from, surface.scale);
  get(from, refined);
  if (refined) get(from, surface.refine.emplace());
  SurfaceField field;
  field.grid = BrickGrid(get_bricks(from), context);
  field.inside = get_sides(from, field.grid);
  field.value = Field<float>(field.grid, pages_of(context));
  get_values(from, field.value, {0, field.grid.size()});
  if (is_distance)
    surface.field = DistanceField{std::move(field)};
  else
    surface.field = IndicatorField{std::move(field)};
  return surface;
}

}  // namespace soapfilm
