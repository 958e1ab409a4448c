#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "soapfilm/mesh/topology.h"
#include "soapfilm/version.h"
#include "tools/measure/measure.h"
#include "tools/mesh/json.h"

namespace soapfilm {

namespace {

using nlohmann::ordered_json;

constexpr int measure_version = 1;

/// "12.34 m^3".
std::string with_unit(double value, const std::string& unit, int power) {
  if (unit.empty()) return fmt::format("{:.6g}", value);
  return fmt::format("{:.6g} {}{}", value, unit, power == 1 ? "" : power == 2 ? "^2" : "^3");
}

std::string row(const std::string& name, const std::string& value) { return fmt::format("{:<22} {}\n", name, value); }

std::string plane_name(const Plane& plane) {
  constexpr const char* axes = "xyz";
  for (int k = 0; k < 3; ++k)
    if (plane.normal[k] == 1) return fmt::format("{} = {:.6g}", axes[k], plane.point[k]);
  return fmt::format("the plane at {:.6g},{:.6g},{:.6g}", plane.point.x, plane.point.y, plane.point.z);
}

std::string volume_text(const MeasureSubject& subject, const Measures& m) {
  if (m.volume)
    return with_unit(*m.volume, subject.unit, 3) +
           (m.inside_out ? ", of what the surface encloses: its faces look inward, as of a room" : "");
  return fmt::format("none: the mesh is open ({} boundary edges); --above z=Z gives the volume above a plane",
                     m.topology.boundary_edges);
}

std::string plane_rows(const MeasureSubject& subject, const Measures& m) {
  const VolumeAtPlane& v = *m.at_plane;
  const auto side = [&](double volume, double footprint) {
    std::string text = with_unit(volume, subject.unit, 3);
    if (v.is_sheet) text += fmt::format(", over an area of {}", with_unit(footprint, subject.unit, 2));
    if (!v.is_sheet && !m.volume) text += ", without what is missing at its holes";
    return text;
  };
  const std::string plane = plane_name(*subject.options.above);
  return row("above " + plane, side(v.above, v.footprint_above)) +
         row("below " + plane, side(v.below, v.footprint_below));
}

std::string estimated_text(const Estimated& value, const std::string& unit) {
  return fmt::format("{}, +- {:.1g}", with_unit(value.value, unit, 3), value.error);
}

std::string columns_rows(const MeasureSubject& subject, const VolumesBetween& v) {
  std::string text =
      row("  columns", fmt::format("{} of {}, over an area of {}; +- is about the grid's error", v.columns,
                                   with_unit(v.cell, subject.unit, 1), with_unit(v.footprint, subject.unit, 2)));
  if (v.left_out > 0)
    text += row("  left out", fmt::format("an area of {} where only one of the meshes is, or one has a hole",
                                          with_unit(v.left_out, subject.unit, 2)));
  return text;
}

std::string section_row(const MeasureSubject& subject, const Section& s) {
  const std::string name = "section " + plane_name(s.plane);
  if (s.contours.empty()) return row(name, "empty: the plane does not meet the mesh");
  const auto open = static_cast<size_t>(
      std::count_if(s.contours.begin(), s.contours.end(), [](const Contour& c) { return !c.closed; }));
  const std::string area = open == s.contours.size() ? "no area (open)" : with_unit(s.area(), subject.unit, 2);
  return row(name,
             fmt::format("{}, {} contour{}{}, length {}", area, s.contours.size(), s.contours.size() == 1 ? "" : "s",
                         open > 0 ? fmt::format(" ({} open)", open) : "", with_unit(s.length(), subject.unit, 1)));
}

ordered_json plane_json(const Plane& plane) {
  return {{"point", json_of(plane.point)}, {"normal", json_of(plane.normal)}};
}

ordered_json estimated_json(const Estimated& e) { return {{"volume", e.value}, {"error", e.error}}; }

ordered_json between_json(const std::string& file, const VolumesBetween& v) {
  return {{"mesh", file},
          {"fill", estimated_json(v.fill)},
          {"cut", v.cut ? estimated_json(*v.cut) : ordered_json(nullptr)},
          {"net", estimated_json(v.net)},
          {"cell", v.cell},
          {"columns", v.columns},
          {"footprint", v.footprint},
          {"left_out", v.left_out}};
}

ordered_json sections_json(const Measures& m) {
  ordered_json sections = ordered_json::array();
  for (const Section& s : m.sections)
    sections.push_back({{"plane", plane_json(s.plane)},
                        {"area", s.area()},
                        {"length", s.length()},
                        {"contours", s.contours.size()},
                        {"closed", s.closed()}});
  return sections;
}

}  // namespace

std::string measure_table(const MeasureSubject& subject, const Measures& m) {
  const std::string& unit = subject.unit;
  const Vec3d size = m.box.size();
  std::string text = row("mesh", summary(m.topology));
  text += row("extents", fmt::format("{:.6g} x {:.6g} x {}", size.x, size.y, with_unit(size.z, unit, 1)));
  text += row("area", with_unit(m.area, unit, 2));
  text += row("volume", volume_text(subject, m));
  if (subject.voxel > 0 && m.volume) {
    const double change = m.area * subject.voxel;
    text += row("  per voxel of offset", fmt::format("+- {} ({:.3g} %)", with_unit(change, unit, 3),
                                                     *m.volume > 0 ? 100 * change / *m.volume : 0.0));
  }
  if (m.at_plane) text += plane_rows(subject, m);
  if (m.above_mesh) {
    text += row("above " + subject.base, estimated_text(m.above_mesh->fill, unit));
    if (m.above_mesh->cut) text += row("below " + subject.base, estimated_text(*m.above_mesh->cut, unit));
    text += columns_rows(subject, *m.above_mesh);
  }
  if (m.since) {
    text += row("since " + subject.before, "");
    text += row("  fill (added)", estimated_text(m.since->fill, unit));
    if (m.since->cut) text += row("  cut (taken away)", estimated_text(*m.since->cut, unit));
    text += row("  fill - cut", estimated_text(m.since->net, unit));
    text += columns_rows(subject, *m.since);
  }
  for (const Section& s : m.sections) text += section_row(subject, s);
  return text;
}

ordered_json measure_json(const MeasureSubject& subject, const Measures& m) {
  ordered_json json = {{"format", "soapfilm measures"},
                       {"measure_version", measure_version},
                       {"soapfilm", version},
                       {"mesh", subject.mesh},
                       {"unit", subject.unit.empty() ? ordered_json(nullptr) : ordered_json(subject.unit)},
                       {"extents", json_of(m.box)},
                       {"area", m.area},
                       {"volume", or_null(m.volume)},
                       {"inside_out", m.inside_out},
                       {"volume_per_voxel", nullptr},
                       {"at_plane", nullptr},
                       {"above_mesh", nullptr},
                       {"since", nullptr},
                       {"sections", sections_json(m)}};
  if (subject.voxel > 0) json["volume_per_voxel"] = m.area * subject.voxel;
  if (m.at_plane)
    json["at_plane"] = {{"plane", plane_json(*subject.options.above)},
                        {"above", m.at_plane->above},
                        {"below", m.at_plane->below},
                        {"sheet", m.at_plane->is_sheet},
                        {"footprint_above", m.at_plane->footprint_above},
                        {"footprint_below", m.at_plane->footprint_below}};
  if (m.above_mesh) json["above_mesh"] = between_json(subject.base, *m.above_mesh);
  if (m.since) json["since"] = between_json(subject.before, *m.since);
  json["topology"] = {{"closed", m.topology.closed()},
                      {"manifold", m.topology.manifold()},
                      {"components", m.topology.components.size()},
                      {"boundary_edges", m.topology.boundary_edges},
                      {"triangles", m.topology.triangles}};
  return json;
}

}  // namespace soapfilm
