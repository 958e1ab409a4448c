// The tools in Python: a mesh beside the truth, a virtual scanner, pictures. Built where the tools are.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "arrays.h"
#include "given.h"
#include "points.h"
#include "result.h"
#include "soapfilm/core/json_text.h"
#include "tools/compare/compare_report.h"
#include "tools/evaluate/evaluate.h"
#include "tools/evaluate/evaluation_report.h"
#include "tools/measure/measure.h"
#include "tools/render/render.h"
#include "tools/scanner/known_surface.h"
#include "tools/scanner/missing.h"
#include "tools/scanner/sample_surface.h"
#include "tools/view/view.h"
#include "work.h"

namespace soapfilm::python {

namespace {

/// A shape or scene by its name, or a mesh with the name that messages use.
class NamedObject {
 public:
  NamedObject(const py::object& object, std::string name, const Given& shape) : name_(std::move(name)) {
    if (!object.is_none()) mesh_ = py::cast<MeshHolder>(object).mesh;
    shape.take("size", params_.size);
    shape.take("center", params_.center);
    shape.take("thickness", params_.thickness);
    shape.take("gap", params_.gap);
    for (const char* key : {"size", "center", "thickness", "gap"})
      if (shape.has(key) && (mesh_ || surface_name(name_) != SurfaceName::shape))
        throw ParameterError(std::string(key) + ": only built-in shapes have it, " + name_ + " is none");
  }

  KnownSurface surface(const Context& context) const {
    if (mesh_) return known_mesh(*mesh_, name_, context);
    switch (surface_name(name_)) {
      case SurfaceName::shape:
        return known_shape(make_shape(name_, params_), params_.center);
      case SurfaceName::scene:
        return known_scene(name_, context);
      default:
        throw ParameterError(
            fmt::format("shape = {}, must be one of {}, or a mesh", name_, fmt::join(surface_names(), ", ")));
    }
  }

 private:
  std::shared_ptr<const Mesh> mesh_;
  std::string name_;
  ShapeParams params_;
};

/// The JSON of `soapfilm evaluate --json`. `given` has the options, and samples: an array or None.
std::string evaluate_mesh(const MeshHolder& mesh, const py::object& truth, const py::dict& given_values, int threads,
                          const py::object& on_event) {
  const Given given(given_values);
  std::string truth_name;
  EvaluationSubject subject;
  EvaluationOptions& options = subject.options;
  given.take("truth_name", truth_name);
  given.take("mesh_name", subject.mesh);
  given.take("samples_name", subject.samples);
  given.take("voxel", subject.voxel);
  given.take("f_score", options.f_score_distances, "distances");
  given.take("points", options.points, "a whole number");
  given.take("seed", options.seed, "a whole number >= 0");
  const NamedObject object(truth, truth_name, given);
  const Table table(given.has("samples") ? py::object(given_values["samples"]) : py::none());
  std::optional<std::vector<Vec3d>> samples;
  if (table) {
    samples.emplace(table.rows());
    for (size_t i = 0; i < table.rows(); ++i) (*samples)[i] = table.vector<double>(i);
  }
  std::string json;
  work_beside_python(threads, on_event, [&](const Context& context) {
    validate(options);
    require_surface(*mesh.mesh, subject.mesh);
    const KnownSurface known = object.surface(context);
    subject.truth = known.facts;
    const Evaluation found = evaluate(*mesh.mesh, *known.surface, options, context, samples ? &*samples : nullptr);
    json = json_text(evaluation_json(subject, found));
  });
  return json;
}

Plane plane_of(const std::array<double, 6>& v) {
  const Vec3d normal{v[3], v[4], v[5]};
  if (!(norm(normal) > 0) || !is_finite(normal) || !is_finite(Vec3d{v[0], v[1], v[2]}))
    throw ParameterError("plane: must be a point and a normal that is not zero, all finite");
  return {{v[0], v[1], v[2]}, normalized(normal)};
}

/// The JSON of `soapfilm measure --json`. `given` has the options; planes are a point and a normal.
std::string measure_mesh(const MeshHolder& mesh, const py::object& base, const py::object& before,
                         const py::dict& given_values, int threads, const py::object& on_event) {
  const Given given(given_values);
  MeasureSubject subject;
  MeasureOptions& options = subject.options;
  given.take("mesh_name", subject.mesh);
  given.take("base_name", subject.base);
  given.take("before_name", subject.before);
  given.take("voxel", subject.voxel);
  given.take("cell", options.columns.cell);
  std::optional<std::array<double, 6>> above;
  std::optional<std::array<double, 4>> within;
  std::vector<std::array<double, 6>> sections;
  given.take("above", above, "a point and a normal");
  given.take("within", within, "(x0, y0, x1, y1)");
  given.take("sections", sections, "points and normals");
  if (above) options.above = plane_of(*above);
  for (const auto& plane : sections) options.sections.push_back(plane_of(plane));
  if (within) options.columns.window = Window{(*within)[0], (*within)[1], (*within)[2], (*within)[3]};
  const auto mesh_of = [](const py::object& object) {
    return object.is_none() ? nullptr : py::cast<MeshHolder>(object).mesh;
  };
  const std::shared_ptr<const Mesh> ground = mesh_of(base), earlier = mesh_of(before);
  std::string json;
  work_beside_python(threads, on_event, [&](const Context& context) {
    require_surface(*mesh.mesh, subject.mesh);
    if (ground) require_surface(*ground, subject.base);
    if (earlier) require_surface(*earlier, subject.before);
    const Measures found = measure(*mesh.mesh, options, context, ground.get(), earlier.get());
    json = json_text(measure_json(subject, found));
  });
  return json;
}

/// The JSON of `soapfilm compare --json`, of a mesh or of points.
std::string compare_part(const py::object& part, const MeshHolder& model, const py::dict& given_values, int threads,
                         const py::object& on_event) {
  const Given given(given_values);
  CompareSubject subject;
  CompareOptions& options = subject.options;
  given.take("part_name", subject.part);
  given.take("model_name", subject.model);
  given.take("tolerance", options.tolerance);
  given.take("least", options.least);
  given.take("align", options.align, "true or false");
  given.take("points", options.points, "a whole number");
  given.take("seed", options.seed, "a whole number >= 0");
  subject.is_scan = py::isinstance<Points>(part);
  std::shared_ptr<const Mesh> mesh;
  std::shared_ptr<const PointCloud> cloud;
  if (subject.is_scan)
    cloud = py::cast<Points&>(part).cloud;
  else
    mesh = py::cast<MeshHolder>(part).mesh;
  std::string json;
  work_beside_python(threads, on_event, [&](const Context& context) {
    validate(options);
    require_surface(*model.mesh, subject.model);
    if (mesh) require_surface(*mesh, subject.part);
    ScanPart scan;
    MeshPart body;
    if (cloud) scan.cloud = *cloud;
    if (mesh) body.mesh = *mesh;
    const Comparison found =
        cloud ? compare(scan, *model.mesh, options, context) : compare(body, *model.mesh, options, context);
    json = json_text(compare_json(subject, found));
  });
  return json;
}

ScannerParams scanner_of(const Given& given, const std::optional<ScannerParams>& scene, const Box3d& box) {
  ScannerParams p = scene.value_or(ScannerParams{});
  if (scene && (given.has("views") || given.has("orbit") || given.has("elevations") || given.has("distance")))
    p.positions.clear();
  given.take("views", p.views, "a whole number");
  given.take_name("orbit", {{"fibonacci", Orbit::fibonacci}, {"ring", Orbit::ring}}, p.orbit);
  given.take("elevations", p.elevations_deg, "degrees");
  given.take("distance", p.distance);
  given.take("positions", p.positions);
  given.take("target", p.target.emplace(p.target.value_or(box.center())));
  given.take_name("rays", {{"central", Rays::central}, {"parallel", Rays::parallel}, {"spinning", Rays::spinning}},
                  p.rays);
  std::pair<int, int> image{p.columns, p.rows};
  given.take("image", image, "columns and rows");
  p.columns = image.first, p.rows = image.second;
  given.take_length("step", box.longest(), p.step);
  given.take_pair("span", p.lowest_deg, p.highest_deg);
  given.take("rings", p.rings_deg, "degrees");
  given.take_length("max_range", box.longest(), p.max_range);
  given.take_length("noise", box.longest(), p.noise);
  given.take("outliers", p.outliers);
  given.take_name("outlier_kind", {{"ray", Outliers::ray}, {"box", Outliers::box}}, p.outlier_kind);
  given.take("drop_out", p.drop_out);
  given.take("max_incidence", p.max_incidence_deg);
  given.take("ghosts", p.ghosts);
  given.take_pair("ghost_depth", p.ghost_lo, p.ghost_hi);
  given.take("mixed_pixels", p.mixed_pixels);
  given.take_length("misalignment", box.longest(), p.misalignment);
  given.take("misalignment_angle", p.misalignment_deg);
  given.take("normals", p.normals, "True or False");
  given.take("seed", p.seed, "a whole number >= 0");
  return p;
}

/// What is measured, and how.
struct Measurement {
  ScannerParams scanner;
  size_t samples = 0;  ///< > 0: so many, even by area, in place of scans
  bool views = false;  ///< of these: each has a scanner position, no normal
  MissingParams missing;
};

Measurement measurement_of(const Given& given, const KnownSurface& object) {
  Measurement m{scanner_of(given, object.scanner, object.surface->box()), 0, false, {}};
  given.take("samples", m.samples, "a whole number >= 1");
  if (given.has("samples") && (m.samples < 1 || m.samples > 1000000000))
    throw ParameterError("samples = " + std::to_string(m.samples) + ", must be in [1, 1e9]");
  given.take_name("directions", {{"normals", false}, {"views", true}}, m.views);
  given.take("hole", m.missing.hole);
  given.take("sparse_half", m.missing.sparse_half);
  m.missing.seed = m.scanner.seed;
  return m;
}

PointCloud measure(const Measurement& m, const Surface& surface, const Context& context) {
  PointCloud cloud;
  if (m.samples > 0) {
    SamplingParams sampling{m.samples, m.scanner.noise, m.scanner.outliers, {}, m.scanner.seed};
    if (m.views) sampling.sensors = scanner_positions(surface.box(), m.scanner);
    cloud = sample_surface(surface, sampling, context);
  } else {
    cloud = virtual_scan(surface, m.scanner, context).cloud;
  }
  if (m.missing.hole != 0 || m.missing.sparse_half != 1) cloud.filter(kept_samples(surface, cloud, m.missing, context));
  return cloud;
}

Points scan_object(const py::object& object, const std::string& name, const py::dict& given_values, int threads,
                   const py::object& on_event) {
  const Given given(given_values);
  const NamedObject named(object, name, given);
  KnownSurface known;
  work_beside_python(threads, on_event, [&](const Context& context) { known = named.surface(context); });
  const Measurement how = measurement_of(given, known);
  Points points;
  work_beside_python(threads, on_event,
                     [&](const Context& context) { *points.cloud = measure(how, *known.surface, context); });
  return points;
}

RenderParams render_params(const Given& given) {
  RenderParams p;
  std::pair<int, int> size{p.width, p.height};
  given.take("size", size, "width and height");
  p.width = size.first, p.height = size.second;
  given.take("columns", p.columns, "a whole number");
  given.take("up", p.up);
  std::string view = "front";
  if (given.has("direction"))
    given.take("direction", p.from);
  else
    given.take("view", view), p.from = view_direction(view, p.up);
  std::array<double, 4> zoom{0, 0, 1, 1};
  given.take("zoom", zoom, "four numbers");
  p.zoom = {zoom[0], zoom[1], zoom[2], zoom[3]};
  given.take_name("framing",
                  {{"shared", Framing::shared}, {"centered", Framing::centered}, {"fitted", Framing::fitted}},
                  p.framing);
  given.take_name("shading", {{"flat", Shading::flat}, {"smooth", Shading::smooth}}, p.shading);
  given.take("color_by", p.color_by, "a name");
  given.take("range", p.range, "two numbers");
  given.take("point_radius", p.point_radius);
  given.take("samples", p.samples, "a whole number");
  given.take("occlusion_rays", p.occlusion_rays, "a whole number");
  std::array<uint8_t, 3> background{255, 255, 255};
  given.take("background", background, "a color");
  p.background = background;
  if (given.has("transparent")) p.background.reset();
  return p;
}

/// A Mesh or Points of Python, kept alive.
class SharedShape {
 public:
  explicit SharedShape(const py::object& shape) {
    if (py::isinstance<MeshHolder>(shape))
      mesh_ = py::cast<MeshHolder>(shape).mesh;
    else
      cloud_ = py::cast<std::shared_ptr<Points>>(shape)->cloud;
  }
  std::variant<const Mesh*, const PointCloud*> get() const {
    if (mesh_) return mesh_.get();
    return cloud_.get();
  }

 private:
  std::shared_ptr<const Mesh> mesh_;
  std::shared_ptr<const PointCloud> cloud_;
};

/// (width, height, RGBA). `shapes`: (Mesh or Points, caption) each. `path`: a PNG to write, or empty.
py::tuple render_items(const py::list& shapes, const py::dict& given_values, const std::string& path, int threads,
                       const py::object& on_event) {
  const RenderParams params = render_params(Given(given_values));
  std::vector<SharedShape> owners;
  std::vector<RenderItem> items;
  for (const py::handle& entry : shapes) {
    const auto [shape, caption] = py::cast<std::pair<py::object, std::string>>(entry);
    items.push_back({owners.emplace_back(shape).get(), caption});
  }
  Image image;
  work_beside_python(threads, on_event, [&](const Context& context) {
    image = render(items, params, context);
    if (!path.empty()) write_png(path, image);
  });
  const auto* bytes = reinterpret_cast<const char*>(image.pixels.data());
  return py::make_tuple(image.width, image.height, py::bytes(bytes, image.pixels.size() * sizeof(Rgba8)));
}

/// The page of `soapfilm view`. `shapes`: (Mesh or Points, name, report as JSON or "") each.
py::str view_items(const py::list& shapes, const py::dict& given_values, int threads, const py::object& on_event) {
  const Given given(given_values);
  ViewParams params;
  given.take("title", params.title);
  given.take("unit", params.unit);
  given.take_name("up", {{"y", UpAxis::y}, {"z", UpAxis::z}}, params.up);
  given.take("triangles", params.triangles, "a whole number >= 0");
  given.take("samples", params.samples, "a whole number >= 0");
  std::vector<SharedShape> owners;
  std::vector<ViewItem> items;
  for (const py::handle& entry : shapes) {
    const auto [shape, name, report] = py::cast<std::tuple<py::object, std::string, std::string>>(entry);
    items.push_back({owners.emplace_back(shape).get(), name, report});
  }
  std::string page;
  work_beside_python(threads, on_event, [&](const Context& context) { page = viewer_page(items, params, context); });
  return page;
}

}  // namespace

void add_tools(py::module_& module) {
  module.def("evaluate", &evaluate_mesh);
  module.def("measure", &measure_mesh);
  module.def("compare", &compare_part);
  module.def("scan", &scan_object);
  module.def("render", &render_items);
  module.def("view", &view_items);
  module.attr("has_viewer") = has_viewer();
}

}  // namespace soapfilm::python
