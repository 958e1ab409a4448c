// The C interface, implemented on the C++ one: every exception is converted to a status and a line of text.
#include "soapfilm/soapfilm.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/simplify.h"
#include "soapfilm/version.h"

namespace {

using namespace soapfilm;

/// Passes events of the library to a C function.
class Listener : public Progress {
 public:
  void (*callback)(void*, soapfilm_event, double, const char*) = nullptr;
  void* user = nullptr;

  void begin_stage(std::string_view name) override { tell(SOAPFILM_STAGE, 0, std::string(name)); }
  void advance(double fraction, std::string_view detail) override {
    tell(SOAPFILM_ADVANCE, fraction, std::string(detail));
  }
  void info(const std::string& line) override { tell(SOAPFILM_INFO, 0, line); }
  void warn(const std::string& line) override { tell(SOAPFILM_WARNING, 0, line); }

 private:
  void tell(soapfilm_event event, double fraction, const std::string& text) const {
    if (callback) callback(user, event, fraction, text.c_str());
  }
};

}  // namespace

struct soapfilm_context {
  explicit soapfilm_context(int threads) : context(threads, listener) {}
  Listener listener;
  Context context;
  std::string error;
};

struct soapfilm_cloud {
  Reconstructor scans;
};

struct soapfilm_result {
  Reconstruction reconstruction;
  std::string report;
};

namespace {

/// Converts exceptions from `work` to a status and the context's error line.
template <class Work>
soapfilm_status guarded(soapfilm_context* context, Work&& work) noexcept {
  const auto failed = [&](soapfilm_status status, const char* what) {
    try {
      context->error = what;
    } catch (...) {
      context->error.clear();
    }
    return status;
  };
  try {
    work();
    return SOAPFILM_OK;
  } catch (const ParameterError& error) {
    return failed(SOAPFILM_REFUSED, error.what());
  } catch (const InputError& error) {
    return failed(SOAPFILM_UNREADABLE, error.what());
  } catch (const OutputError& error) {
    return failed(SOAPFILM_UNWRITABLE, error.what());
  } catch (const MemoryError& error) {
    return failed(SOAPFILM_OUT_OF_MEMORY, error.what());
  } catch (const std::bad_alloc&) {
    return failed(SOAPFILM_OUT_OF_MEMORY, "out of memory");
  } catch (const EmptyResult& error) {
    return failed(SOAPFILM_EMPTY, error.what());
  } catch (const Cancelled& error) {
    context->listener.resume();
    return failed(SOAPFILM_CANCELLED, error.what());
  } catch (const std::exception& error) {
    return failed(SOAPFILM_FAILED, error.what());
  } catch (...) {
    return failed(SOAPFILM_FAILED, "unknown exception");
  }
}

/// A column of a table of a C caller.
class Table {
 public:
  /// `values` per row. Throws ParameterError.
  Table(const soapfilm_array& array, size_t values, const char* name, bool bytes = false)
      : data_(static_cast<const char*>(array.data)), type_(array.type) {
    if (!data_) return;
    const size_t size = type_ == SOAPFILM_FLOAT64 ? sizeof(double) : type_ == SOAPFILM_FLOAT32 ? sizeof(float) : 1;
    if ((type_ == SOAPFILM_UINT8) != bytes || type_ < SOAPFILM_FLOAT32 || type_ > SOAPFILM_UINT8)
      throw ParameterError(fmt::format("{}: type = {}, must be {}", name, static_cast<int>(type_),
                                       bytes ? "SOAPFILM_UINT8" : "SOAPFILM_FLOAT32 or SOAPFILM_FLOAT64"));
    size_ = size;
    stride_ = array.stride != 0 ? array.stride : static_cast<ptrdiff_t>(values * size);
  }

  explicit operator bool() const { return data_ != nullptr; }
  double operator()(size_t row, size_t k) const {
    const char* at = data_ + static_cast<ptrdiff_t>(row) * stride_ + k * size_;
    if (type_ == SOAPFILM_UINT8) return static_cast<unsigned char>(*at);
    if (type_ == SOAPFILM_FLOAT32) return load<float>(at);
    return load<double>(at);
  }
  Vec3d vector(size_t row) const { return {(*this)(row, 0), (*this)(row, 1), (*this)(row, 2)}; }

 private:
  /// A caller's rows may be unaligned.
  template <class T>
  static double load(const char* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return value;
  }

  const char* data_;
  soapfilm_type type_;
  size_t size_ = 0;
  ptrdiff_t stride_ = 0;
};

/// A further column for a cloud. Throws ParameterError.
Column column_of(const soapfilm_column& given, const PointCloud& cloud) {
  Column column{given.name ? given.name : "", std::vector<float>(cloud.size()), given.is_label != 0};
  const Table values(given.values, 1, "column");
  if (column.name.empty() || !values) throw ParameterError("column: name or data = null, both must be given");
  for (const Column& other : cloud.columns)
    if (other.name == column.name) throw ParameterError(fmt::format("column \"{}\" is given twice", column.name));
  for (size_t i = 0; i < cloud.size(); ++i) column.values[i] = static_cast<float>(values(i, 0));
  return column;
}

PointCloud cloud_of(const soapfilm_samples& samples) {
  const Table position(samples.position, 3, "position"), normal(samples.normal, 3, "normal"),
      sensor(samples.sensor, 3, "sensor"), weight(samples.weight, 1, "weight"), color(samples.color, 3, "color", true);
  const size_t count = samples.count;
  if (count == 0) throw SamplesError("count = 0, must be at least 1");
  if (!position) throw ParameterError("position: data = null, must be given");
  PointCloud cloud;
  cloud.positions.resize(count);
  if (normal) cloud.normals.resize(count);
  if (sensor) cloud.sensors.resize(count);
  if (weight) cloud.weights.resize(count);
  if (color) cloud.colors.resize(count);
  for (size_t i = 0; i < count; ++i) {
    cloud.positions[i] = position.vector(i);
    if (!is_finite(cloud.positions[i])) throw SamplesError(fmt::format("sample {}: position is not finite", i));
    if (normal) {
      const Vec3d n = normal.vector(i);
      const auto [x, y, z] = is_finite(n) ? n : Vec3d{};
      cloud.normals[i] = {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
    }
    if (sensor) cloud.sensors[i] = sensor.vector(i);
    if (weight) {
      const double w = weight(i, 0);
      if (!(w >= 0 && std::isfinite(w)))
        throw SamplesError(fmt::format("sample {}: weight = {:g}, must be >= 0 and finite", i, w));
      cloud.weights[i] = static_cast<float>(w);
    }
    if (color)
      for (size_t k = 0; k < 3; ++k) cloud.colors[i][k] = static_cast<uint8_t>(color(i, k));
  }
  for (size_t c = 0; c < samples.column_count; ++c) cloud.columns.push_back(column_of(samples.columns[c], cloud));
  Scan scan;
  scan.name = samples.name ? samples.name : "";
  scan.end = count;
  if (samples.scanner) {
    scan.sensor = Vec3d{samples.scanner[0], samples.scanner[1], samples.scanner[2]};
    if (!is_finite(*scan.sensor)) throw ParameterError("scanner: not finite");
  }
  cloud.scans.push_back(std::move(scan));
  return cloud;
}

Mesh mesh_of(const double* vertices, size_t vertex_count, const uint32_t* triangles, size_t triangle_count) {
  if (!vertices || !triangles) throw ParameterError("vertices or triangles = null, both must be given");
  Mesh mesh;
  for (size_t v = 0; v < vertex_count; ++v) {
    mesh.vertices.push_back({vertices[3 * v], vertices[3 * v + 1], vertices[3 * v + 2]});
    if (!is_finite(mesh.vertices.back())) throw ParameterError(fmt::format("vertex {}: not finite", v));
  }
  for (size_t t = 0; t < triangle_count; ++t) {
    mesh.triangles.push_back({triangles[3 * t], triangles[3 * t + 1], triangles[3 * t + 2]});
    for (const uint32_t v : mesh.triangles.back())
      if (v >= vertex_count)
        throw ParameterError(fmt::format("triangle {}: vertex {}, must be in [0, {})", t, v, vertex_count));
  }
  return mesh;
}

}  // namespace

const char* soapfilm_version(void) { return version; }

soapfilm_context* soapfilm_context_create(int threads) try { return new soapfilm_context(threads); } catch (...) {
  return nullptr;
}

void soapfilm_context_destroy(soapfilm_context* context) { delete context; }

const char* soapfilm_error(const soapfilm_context* context) { return context->error.c_str(); }

void soapfilm_cancel(soapfilm_context* context) { context->listener.cancel(); }

void soapfilm_limit_memory(soapfilm_context* context, size_t bytes) {
  context->context.limit_memory(bytes > 0 ? std::optional(bytes) : std::nullopt);
}
void soapfilm_set_scratch_folder(soapfilm_context* context, const char* folder) {
  context->context.set_scratch_folder(folder ? folder : "");
}

void soapfilm_on_event(soapfilm_context* context, void (*callback)(void*, soapfilm_event, double, const char*),
                       void* user) {
  context->listener.callback = callback;
  context->listener.user = user;
}

soapfilm_cloud* soapfilm_cloud_create(void) { return new (std::nothrow) soapfilm_cloud; }

void soapfilm_cloud_destroy(soapfilm_cloud* cloud) { delete cloud; }

size_t soapfilm_cloud_size(const soapfilm_cloud* cloud) { return cloud->scans.cloud().size(); }

soapfilm_status soapfilm_cloud_append(soapfilm_context* context, soapfilm_cloud* cloud,
                                      const soapfilm_samples* samples) {
  return guarded(context, [&] {
    std::array<double, 16> pose{};
    if (samples->pose) std::copy_n(samples->pose, pose.size(), pose.begin());
    cloud->scans.add(cloud_of(*samples), samples->pose ? &pose : nullptr);
  });
}

soapfilm_status soapfilm_cloud_read(soapfilm_context* context, soapfilm_cloud* cloud, const char* path) {
  return guarded(context, [&] {
    ReadReport read;
    PointCloud found = read_points(std::string(path), &read, context->context);
    for (const std::string& warning : read.warnings) context->listener.warn(warning);
    cloud->scans.add(std::move(found));
  });
}

soapfilm_status soapfilm_reconstruct(soapfilm_context* context, const soapfilm_cloud* cloud, const char* parameters,
                                     soapfilm_result** result) {
  *result = nullptr;
  return guarded(context, [&] {
    const ReconstructParams params = parameters ? params_from_json(parameters) : ReconstructParams{};
    auto found = std::make_unique<soapfilm_result>();
    found->reconstruction = cloud->scans.reconstruct(params, context->context);
    found->report = to_json(found->reconstruction.report);
    *result = found.release();
  });
}

void soapfilm_result_destroy(soapfilm_result* result) { delete result; }

size_t soapfilm_vertex_count(const soapfilm_result* result) { return result->reconstruction.mesh.vertices.size(); }

const double* soapfilm_vertices(const soapfilm_result* result) {
  static_assert(sizeof(Vec3d) == 3 * sizeof(double));
  return &result->reconstruction.mesh.vertices.data()->x;
}

size_t soapfilm_triangle_count(const soapfilm_result* result) { return result->reconstruction.mesh.triangles.size(); }

const uint32_t* soapfilm_triangles(const soapfilm_result* result) {
  static_assert(sizeof(Triangle) == 3 * sizeof(uint32_t));
  return result->reconstruction.mesh.triangles.data()->data();
}

const uint8_t* soapfilm_colors(const soapfilm_result* result) {
  const auto& colors = result->reconstruction.mesh.colors;
  return colors.empty() ? nullptr : colors.data()->data();
}

const char* soapfilm_attribute_name(const soapfilm_result* result, size_t index) {
  const auto& attributes = result->reconstruction.mesh.attributes;
  return index < attributes.size() ? attributes[index].name.c_str() : nullptr;
}

const float* soapfilm_attribute(const soapfilm_result* result, const char* name) {
  for (const soapfilm::Column& attribute : result->reconstruction.mesh.attributes)
    if (attribute.name == name) return attribute.values.data();
  return nullptr;
}

const char* soapfilm_report(const soapfilm_result* result) { return result->report.c_str(); }

soapfilm_status soapfilm_mesh_create(soapfilm_context* context, const double* vertices, size_t vertex_count,
                                     const uint32_t* triangles, size_t triangle_count, soapfilm_result** result) {
  *result = nullptr;
  return guarded(context, [&] {
    auto made = std::make_unique<soapfilm_result>();
    made->reconstruction.mesh = mesh_of(vertices, vertex_count, triangles, triangle_count);
    made->report = "{}";
    *result = made.release();
  });
}

soapfilm_status soapfilm_simplify(soapfilm_context* context, const soapfilm_result* result, double tolerance,
                                  size_t triangles, soapfilm_result** simplified) {
  *simplified = nullptr;
  return guarded(context, [&] {
    const Mesh& mesh = result->reconstruction.mesh;
    Simplified found =
        triangles > 0 ? simplify_to(mesh, triangles, context->context) : simplify(mesh, tolerance, context->context);
    auto made = std::make_unique<soapfilm_result>();
    made->reconstruction.mesh = std::move(found.mesh);
    made->reconstruction.report.params.orient.up = result->reconstruction.report.params.orient.up;
    const SimplifyReport& r = found.report;
    made->report = fmt::format(R"({{"triangles_before": {}, "triangles": {}, "tolerance": {}, "proved": {}}})",
                               r.triangles_before, r.triangles, r.tolerance, r.proved);
    *simplified = made.release();
  });
}

soapfilm_status soapfilm_write_mesh(soapfilm_context* context, const soapfilm_result* result, const char* path) {
  return guarded(context, [&] {
    WriteOptions options;
    options.up = result->reconstruction.report.params.orient.up.value_or(Axis::z);
    write_mesh(path, result->reconstruction.mesh, options, context->context);
  });
}
