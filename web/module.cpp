// What the page calls: files of the browser become a cloud, the cloud a mesh. Built by Emscripten; worker.js calls it.
#include <emscripten.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io.h"
#include "soapfilm/io/summary.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/run/memory_plan.h"
#include "soapfilm/simplify.h"
#include "soapfilm/version.h"

// clang-format off
EM_JS(void, web_event, (const char* kind, double fraction, const char* text), {
  Module.onEvent(UTF8ToString(kind), fraction, UTF8ToString(text));
});
// clang-format on

namespace soapfilm {

namespace {

using nlohmann::ordered_json;

/// Hands every event to the worker. It runs on the same thread: cancelling is ending the worker.
class WebProgress : public Progress {
 public:
  void begin_stage(std::string_view name) override { tell("stage", 0, std::string(name)); }
  void advance(double fraction, std::string_view detail) override { tell("advance", fraction, std::string(detail)); }
  void info(const std::string& line) override { tell("info", 0, line); }
  void warn(const std::string& line) override { tell("warning", 0, line); }

 private:
  static void tell(const char* kind, double fraction, const std::string& text) {
    web_event(kind, fraction, text.c_str());
  }
};

/// The one run of a worker.
struct Run {
  WebProgress progress;
  Context context{1, progress};
  PointCloud cloud;
  Mesh mesh;         // what was reconstructed or simplified
  WriteOptions how;  // it is written
  std::string report;
  Mesh given;  // to be simplified
  std::vector<float> preview;
  std::string text;
  std::vector<std::string> warnings;
};

Run& run() {
  static Run one;
  return one;
}

Mesh& mesh_of(bool given) { return given ? run().given : run().mesh; }

/// The parameters of JavaScript have `memory.limit`, bytes, for the context, which it does not see.
ReconstructParams params_of(const char* text) {
  ordered_json json = ordered_json::parse(text, nullptr, false);
  run().context.limit_memory(std::nullopt);
  if (!json.is_object() || !json.contains("memory") || !json["memory"].is_object()) return params_from_json(text);
  const ordered_json limit = json["memory"].value("limit", ordered_json(nullptr));
  json["memory"].erase("limit");
  if (!limit.is_null() && !limit.is_number_unsigned())
    throw ParameterError("memory.limit = " + limit.dump() + ", must be a whole number >= 0");
  if (!limit.is_null()) run().context.limit_memory(limit.get<size_t>());
  return params_from_json(json.dump());
}

/// "" or the message of what was refused.
template <class Work>
const char* guarded(const Work& work) {
  static std::string message;
  message.clear();
  try {
    work();
  } catch (const std::bad_alloc&) {
    message = "not enough memory: a browser gives a page at most 4 GiB; take a larger voxel";
  } catch (const std::exception& error) {
    message = error.what();
  }
  return message.c_str();
}

ordered_json json_of(Vec3d v) { return {v.x, v.y, v.z}; }

std::string text_of(const ordered_json& json) {
  return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace

}  // namespace soapfilm

using namespace soapfilm;

extern "C" {

EMSCRIPTEN_KEEPALIVE const char* web_version() { return version; }

/// Appends a file. Returns "" or why not.
EMSCRIPTEN_KEEPALIVE const char* web_read(const char* path) {
  return guarded([&] {
    ReadReport report;
    PointCloud cloud = read_points(path, &report, run().context);
    for (const std::string& warning : report.warnings) run().progress.warn(warning);
    run().warnings.insert(run().warnings.end(), report.warnings.begin(), report.warnings.end());
    run().cloud.append(std::move(cloud));
  });
}

/// Finds what was read, for web_summary_text(); with it the smallest voxel, input units, that fits into the memory of
/// `parameters`, or 0. Returns "" or why not.
EMSCRIPTEN_KEEPALIVE const char* web_summary(const char* parameters) {
  return guarded([&] {
    const ReconstructParams params = params_of(parameters);
    const CloudSummary summary = summarize(run().cloud);
    const double area = static_cast<double>(run().cloud.size()) * summary.spacing * summary.spacing;
    const double smallest = smallest_voxel(run().cloud, area, params, run().context);
    const ordered_json json = {{"samples", run().cloud.size()},
                               {"smallest_voxel", smallest},
                               {"scans", run().cloud.scans.size()},
                               {"spacing", summary.spacing},
                               {"normals", summary.normals},
                               {"colors", !run().cloud.colors.empty()},
                               {"coordinate_system", run().cloud.coordinate_system},
                               {"box", {{"lo", json_of(summary.box.lo)}, {"hi", json_of(summary.box.hi)}}}};
    run().text = text_of(json);
  });
}
EMSCRIPTEN_KEEPALIVE const char* web_summary_text() { return run().text.c_str(); }

/// At most `most` samples, chosen evenly at random: x, y, z around an origin, and colors in [0, 1], or -1 without any.
EMSCRIPTEN_KEEPALIVE size_t web_preview(size_t most, double x, double y, double z) {
  const PointCloud& cloud = run().cloud;
  const size_t count = std::min(most, cloud.size());
  std::vector<float>& out = run().preview;
  out.clear();
  for (size_t k = 0; k < count; ++k) {
    const size_t length = cloud.size() / count;
    const size_t i = one_of_stretch(k, length, cloud.size());
    const Vec3f p(cloud.positions[i] - Vec3d{x, y, z});
    out.insert(out.end(), {p.x, p.y, p.z});
    for (int c = 0; c < 3; ++c)
      out.push_back(cloud.colors.empty() ? -1.0F : static_cast<float>(cloud.colors[i][static_cast<size_t>(c)]) / 255);
  }
  return count;
}
EMSCRIPTEN_KEEPALIVE const float* web_preview_data() { return run().preview.data(); }

/// `parameters` as for soapfilm_reconstruct(). Frees the cloud. Returns "" or why not.
EMSCRIPTEN_KEEPALIVE const char* web_reconstruct(const char* parameters) {
  return guarded([&] {
    const ReconstructParams params = params_of(parameters);
    Reconstruction result = reconstruct(std::move(run().cloud), params, run().context);
    std::vector<std::string>& warnings = result.report.warnings;
    warnings.insert(warnings.begin(), run().warnings.begin(), run().warnings.end());
    run().report = to_json(result.report);
    run().mesh = std::move(result.mesh);
    run().how = {};
  });
}
EMSCRIPTEN_KEEPALIVE const char* web_report() { return run().report.c_str(); }

/// Room for a mesh that JavaScript fills in. Returns "" or why not.
EMSCRIPTEN_KEEPALIVE const char* web_give(size_t vertices, size_t triangles, bool normals, bool colors) {
  return guarded([&] {
    Mesh& mesh = run().given = {};
    mesh.vertices.resize(vertices);
    mesh.triangles.resize(triangles);
    if (normals) mesh.normals.resize(vertices);
    if (colors) mesh.colors.resize(vertices);
  });
}
EMSCRIPTEN_KEEPALIVE const char* web_give_attribute(const char* name) {
  return guarded([&] {
    Mesh& mesh = run().given;
    mesh.attributes.push_back({name, std::vector<float>(mesh.vertices.size()), false});
  });
}
/// The mesh of a file instead. Returns "" or why not.
EMSCRIPTEN_KEEPALIVE const char* web_give_file(const char* path) {
  return guarded([&] {
    ReadReport report;
    run().given = {};
    run().given = read_mesh(path, &report);
    for (const std::string& warning : report.warnings) run().progress.warn(warning);
  });
}

/// Of the mesh that was given, or of the one that is there: to `triangles` if > 0, else within the tolerance. It takes
/// that one's place, and its report the other's. Returns "" or why not.
EMSCRIPTEN_KEEPALIVE const char* web_simplify(bool given, double tolerance, size_t triangles) {
  return guarded([&] {
    const Mesh own = given ? std::move(run().given) : Mesh{};
    run().given = {};
    const Mesh& from = given ? own : run().mesh;
    if (!given && from.triangles.empty()) throw ParameterError("simplify: there is no mesh yet");
    Simplified found =
        triangles > 0 ? simplify_to(from, triangles, run().context) : simplify(from, tolerance, run().context);
    const SimplifyReport& report = found.report;
    run().report = text_of({{"triangles_before", report.triangles_before},
                            {"triangles", report.triangles},
                            {"tolerance", report.tolerance},
                            {"proved", report.proved}});
    run().mesh = std::move(found.mesh);
    run().how.coordinate_precision = std::numeric_limits<double>::min();  // what is proved holds for what is written
  });
}

/// The arrays of the mesh that was given (`given`), or of the one that is there; null: it has none.
EMSCRIPTEN_KEEPALIVE size_t web_vertices() { return run().mesh.vertices.size(); }
EMSCRIPTEN_KEEPALIVE size_t web_triangles() { return run().mesh.triangles.size(); }
EMSCRIPTEN_KEEPALIVE Vec3d* web_vertex_data(bool given) { return mesh_of(given).vertices.data(); }
EMSCRIPTEN_KEEPALIVE Triangle* web_triangle_data(bool given) { return mesh_of(given).triangles.data(); }
EMSCRIPTEN_KEEPALIVE Vec3f* web_normal_data(bool given) {
  return mesh_of(given).normals.empty() ? nullptr : mesh_of(given).normals.data();
}
EMSCRIPTEN_KEEPALIVE Rgb8* web_color_data(bool given) {
  return mesh_of(given).colors.empty() ? nullptr : mesh_of(given).colors.data();
}
EMSCRIPTEN_KEEPALIVE const char* web_attribute_name(size_t index) {
  const auto& attributes = run().mesh.attributes;
  return index < attributes.size() ? attributes[index].name.c_str() : nullptr;
}
EMSCRIPTEN_KEEPALIVE float* web_attribute_data(bool given, size_t index) {
  return mesh_of(given).attributes[index].values.data();
}

/// Writes the mesh. Warns of what the format cannot hold. Returns "" or why not.
EMSCRIPTEN_KEEPALIVE const char* web_write(const char* path) {
  return guarded([&] {
    const WriteReport written = write_mesh(path, run().mesh, run().how, run().context);
    for (const std::string& warning : written.warnings) run().progress.warn(warning);
  });
}
}
