#include "tools/view/view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "soapfilm/core/box_of.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/summary.h"
#include "soapfilm/version.h"
#include "tools/view/arrays.h"
#include "tools/view/attributes.h"
#include "tools/view/page.h"
#include "tools/view/reduce.h"

namespace soapfilm {

namespace {

using namespace view_detail;
using nlohmann::ordered_json;

const std::vector<Vec3d>& positions_of(const ViewItem& item) {
  if (const auto* mesh = std::get_if<const Mesh*>(&item.shape)) return (*mesh)->vertices;
  return std::get<const PointCloud*>(item.shape)->positions;
}

void check_length(const std::string& name, const char* what, size_t length, size_t needed) {
  if (length == 0 || length == needed) return;
  throw ParameterError(fmt::format("{}: {} {}, must be {}, one for each position", name, length, what, needed));
}

void check_mesh(const std::string& name, const Mesh& mesh) {
  if (mesh.triangles.empty()) throw ParameterError(fmt::format("{}: 0 triangles, must be at least 1", name));
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const uint32_t highest = *std::max_element(mesh.triangles[t].begin(), mesh.triangles[t].end());
    if (highest >= mesh.vertices.size()) {
      throw ParameterError(
          fmt::format("{}: triangle {} has vertex {}, must be below {}", name, t, highest, mesh.vertices.size()));
    }
  }
}

/// Throws ParameterError for an item that cannot be shown.
void check_item(const ViewItem& item) {
  const std::vector<Vec3d>& positions = positions_of(item);
  if (positions.empty()) throw ParameterError(fmt::format("{}: 0 positions, must be at least 1", item.name));
  if (positions.size() >= UINT32_MAX) {
    throw ParameterError(fmt::format("{}: {} positions, must be fewer than 2^32 - 1", item.name, positions.size()));
  }
  for (size_t i = 0; i < positions.size(); ++i) {
    const Vec3d p = positions[i];
    if (!is_finite(p)) {
      throw ParameterError(fmt::format("{}: position {} is ({}, {}, {}), must be finite", item.name, i, p.x, p.y, p.z));
    }
  }
  const auto check_columns = [&](const auto& shape, const std::vector<Column>& columns) {
    check_length(item.name, "normals", shape.normals.size(), positions.size());
    check_length(item.name, "colors", shape.colors.size(), positions.size());
    for (const Column& column : columns) {
      check_length(item.name, ("values of " + clean_text(column.name)).c_str(), column.values.size(), positions.size());
    }
  };
  if (const auto* mesh = std::get_if<const Mesh*>(&item.shape)) {
    check_mesh(item.name, **mesh);
    check_columns(**mesh, (*mesh)->attributes);
  } else {
    const PointCloud& cloud = *std::get<const PointCloud*>(item.shape);
    check_length(item.name, "weights", cloud.weights.size(), positions.size());
    for (const Scan& scan : cloud.scans) {
      if (scan.begin > scan.end || scan.end > cloud.size()) {
        throw ParameterError(fmt::format("{}: a scan has samples {} to {}, must be in 0 to {}", item.name, scan.begin,
                                         scan.end, cloud.size()));
      }
    }
    check_columns(cloud, cloud.columns);
  }
}

/// Center of the box, rounded to a multiple of a power of two about as large as the box: then the differences of
/// coordinates that were float in the file are float again, mostly without rounding.
Vec3d origin_of(const Box3d& box) {
  const double longest = box.longest();
  if (!(longest > 0)) return box.center();
  const double step = std::exp2(std::ceil(std::log2(longest)));
  Vec3d origin = box.lo + (box.hi - box.lo) * 0.5;
  for (int axis = 0; axis < 3; ++axis) origin[axis] = std::nearbyint(origin[axis] / step) * step + 0.0;
  return is_finite(origin) ? origin : box.lo;
}

ordered_json json_of(Vec3d v) { return {v.x, v.y, v.z}; }
ordered_json json_of(const Box3d& box) { return {{"lo", json_of(box.lo)}, {"hi", json_of(box.hi)}}; }

std::vector<Vec3f> local_positions(const std::vector<Vec3d>& positions, Vec3d origin) {
  std::vector<Vec3f> local(positions.size());
  for (size_t i = 0; i < positions.size(); ++i) local[i] = Vec3f(positions[i] - origin);
  return local;
}

template <class T>
std::vector<T> chosen(const std::vector<T>& values, const std::vector<uint32_t>& which) {
  std::vector<T> out(which.size());
  for (size_t i = 0; i < which.size(); ++i) out[i] = values[which[i]];
  return out;
}

/// Positions, normals and colors of the chosen vertices or samples.
template <class Shape>
void add_common(ordered_json& json, ArrayWriter& writer, const Shape& shape, const std::vector<Vec3f>& positions,
                const std::vector<uint32_t>& which) {
  json["positions"] = writer.add(chosen(positions, which));
  if (!shape.normals.empty()) {
    std::vector<std::array<int16_t, 2>> packed(which.size());
    for (size_t i = 0; i < which.size(); ++i) packed[i] = pack_normal(shape.normals[which[i]]);
    json["normals"] = writer.add(packed);
  }
  if (!shape.colors.empty()) {
    std::vector<std::array<uint8_t, 4>> colors(which.size());
    for (size_t i = 0; i < which.size(); ++i) {
      const Rgb8 color = shape.colors[which[i]];
      colors[i] = {color[0], color[1], color[2], 255};
    }
    json["colors"] = writer.add(colors);
  }
}

void add_attributes(ordered_json& json, ArrayWriter& writer, const std::vector<ShownAttribute>& attributes,
                    const std::vector<uint32_t>& which) {
  json["attributes"] = ordered_json::array();
  for (const ShownAttribute& attribute : attributes) {
    ordered_json entry = attribute.facts;
    entry["data"] = writer.add(chosen(attribute.values, which));
    json["attributes"].push_back(std::move(entry));
  }
}

ordered_json mesh_json(const ViewItem& item, const Mesh& mesh, Vec3d origin, const ViewParams& params,
                       const Context& context, ArrayWriter& writer) {
  const std::vector<Vec3f> positions = local_positions(mesh.vertices, origin);
  const DrawnMesh drawn = drawn_mesh(mesh, positions, params.triangles);
  const size_t triangles = drawn.indices.size() / 3;
  if (triangles < mesh.triangles.size()) {
    context.progress().info(
        fmt::format("{}: simplified from {} to {} triangles for the page; moved by about {:.2g} at most",
                    clean_text(item.name), mesh.triangles.size(), triangles, drawn.error));
  }
  ordered_json json = {{"kind", "mesh"},
                       {"vertices", drawn.vertices.size()},
                       {"triangles", triangles},
                       {"source", {{"vertices", mesh.vertices.size()}, {"triangles", mesh.triangles.size()}}},
                       {"error", drawn.error}};
  json["indices"] = writer.add_indices(drawn.indices, drawn.vertices.size());
  add_common(json, writer, mesh, positions, drawn.vertices);
  add_attributes(json, writer, shown_attributes(mesh), drawn.vertices);
  return json;
}

ordered_json cloud_json(const ViewItem& item, const PointCloud& cloud, Vec3d origin, const ViewParams& params,
                        const Context& context, ArrayWriter& writer) {
  const std::vector<Vec3f> positions = local_positions(cloud.positions, origin);
  const std::vector<uint32_t> kept = thinned(cloud.size(), params.samples);
  if (kept.size() < cloud.size()) {
    context.progress().info(fmt::format("{}: thinned from {} to {} samples for the page", clean_text(item.name),
                                        cloud.size(), kept.size()));
  }
  const std::vector<uint32_t> which = sorted_in_space(kept, positions);
  // Fewer samples on the same surface are larger, so that it stays closed.
  const double share = static_cast<double>(cloud.size()) / static_cast<double>(kept.size());
  const double spacing = sample_spacing(cloud) * std::sqrt(share);
  const double longest = box_of(cloud.positions).longest();
  ordered_json json = {{"kind", "samples"},
                       {"samples", kept.size()},
                       {"source", {{"samples", cloud.size()}, {"scans", cloud.scans.size()}}},
                       {"radius", spacing > 0   ? 0.7 * spacing
                                  : longest > 0 ? 1e-3 * longest
                                                : 1.0}};
  add_common(json, writer, cloud, positions, which);
  add_attributes(json, writer, shown_attributes(cloud), which);
  return json;
}

ordered_json report_json(const ViewItem& item) {
  if (item.report.empty()) return nullptr;
  ordered_json report = ordered_json::parse(item.report, nullptr, false);
  if (report.is_object()) return report;
  throw ParameterError(
      fmt::format("{}: its report is no JSON object, must be what reconstruct --report writes", clean_text(item.name)));
}

std::string title_of(const std::vector<ViewItem>& items, const ViewParams& params) {
  if (!params.title.empty()) return clean_text(params.title);
  std::string title;
  for (const ViewItem& item : items) title += (title.empty() ? "" : ", ") + clean_text(item.name);
  return title;
}

}  // namespace

bool has_viewer() { return !built_page().empty(); }

namespace view_detail {

std::string page_of(std::string_view page, const std::vector<ViewItem>& items, const ViewParams& params,
                    const Context& context) {
  if (items.empty()) throw ParameterError("there are 0 items to view, must be at least 1");
  Box3d box;
  for (const ViewItem& item : items) {
    check_item(item);
    box.extend(box_of(positions_of(item)));
  }
  const Vec3d origin = origin_of(box);
  const std::string title = title_of(items, params);
  ordered_json scene = {{"version", version},
                        {"title", title},
                        {"unit", clean_text(params.unit)},
                        {"up", params.up == UpAxis::y ? "y" : "z"},
                        {"origin", json_of(origin)},
                        {"items", ordered_json::array()}};
  ArrayWriter writer;
  for (const ViewItem& item : items) {
    context.check();
    const auto* mesh = std::get_if<const Mesh*>(&item.shape);
    ordered_json json =
        mesh ? mesh_json(item, **mesh, origin, params, context, writer)
             : cloud_json(item, *std::get<const PointCloud*>(item.shape), origin, params, context, writer);
    json["name"] = clean_text(item.name);
    json["box"] = json_of(box_of(positions_of(item)));
    json["report"] = report_json(item);
    scene["items"].push_back(std::move(json));
  }
  scene["characters"] = writer.characters();
  return fill_page(page, title, scene, writer.arrays());
}

}  // namespace view_detail

std::string viewer_page(const std::vector<ViewItem>& items, const ViewParams& params, const Context& context) {
  if (!has_viewer()) {
    throw OutputError(
        "this build has no viewer: install node and npm (on Debian: apt-get install nodejs npm), then build again with "
        "cmake -DSOAPFILM_VIEWER=ON");
  }
  return page_of(built_page(), items, params, context);
}

}  // namespace soapfilm
