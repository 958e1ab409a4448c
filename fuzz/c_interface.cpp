// Calls of the C interface in any order that its header allows, with arrays of any stride and type, tiny clouds, events
// and cancelling. No call fails by a fault of the library, messages are one line, results hang together.
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <vector>

#include "fuzz/fuzzer.h"
#include "soapfilm/soapfilm.h"

namespace {

using soapfilm::fuzz::Decisions;
using soapfilm::fuzz::require;
using soapfilm::fuzz::require_one_line;

/// Numbers as scans have them, and such as upset arithmetic.
double number(Decisions& next) {
  constexpr std::array<double, 12> nasty{0,     -0.0,  1e-300, 1e300, -1e300, 1e38,
                                         1e-45, 1e-10, 1e6,    5e5,   -1,     std::numeric_limits<double>::infinity()};
  const uint8_t byte = next.byte();
  if (byte == 255) return std::numeric_limits<double>::quiet_NaN();
  if (byte >= 243) return nasty[byte - 243u];
  return (byte - 121) / 64.0;
}

/// A table in memory of its exact size, so that a byte read beyond it is seen.
class OwnArray {
 public:
  /// `values` per row.
  OwnArray(Decisions& next, size_t count, size_t values, bool bytes) {
    if (next.one_in(5)) return;  // no such column
    array_.type = bytes ? SOAPFILM_UINT8 : next.below(2) == 0 ? SOAPFILM_FLOAT32 : SOAPFILM_FLOAT64;
    const size_t size = bytes ? 1 : array_.type == SOAPFILM_FLOAT32 ? sizeof(float) : sizeof(double);
    const auto row = static_cast<ptrdiff_t>(size * values);
    constexpr std::array<ptrdiff_t, 6> extra{0, 0, 4, 1, 13, -1};  // unaligned and overlapping rows, too
    const ptrdiff_t stride = row + extra[next.below(extra.size())];
    const bool backwards = next.one_in(6);
    const size_t steps = count > 0 ? count - 1 : 0;
    bytes_ = std::make_unique<char[]>(steps * static_cast<size_t>(stride) + static_cast<size_t>(row));
    for (size_t i = 0; i < count; ++i)
      for (size_t k = 0; k < values; ++k) store(next, i * static_cast<size_t>(stride) + k * size, array_.type);
    array_.data = bytes_.get() + (backwards ? steps * static_cast<size_t>(stride) : 0);
    array_.stride = backwards ? -stride : stride == row ? 0 : stride;
    // A type that the column may not have: refused before anything is read.
    if (next.one_in(32)) array_.type = bytes ? SOAPFILM_FLOAT32 : SOAPFILM_UINT8;
  }
  const soapfilm_array& array() const { return array_; }

 private:
  void store(Decisions& next, size_t at, soapfilm_type type) {
    if (type == SOAPFILM_UINT8) {
      bytes_[at] = static_cast<char>(next.byte());
    } else if (type == SOAPFILM_FLOAT64) {
      const double value = number(next);
      std::memcpy(&bytes_[at], &value, sizeof value);
    } else {
      const double wide = number(next);
      const bool fits = !(std::abs(wide) > std::numeric_limits<float>::max()) || std::isinf(wide);
      const float value = fits ? static_cast<float>(wide) : std::numeric_limits<float>::max();
      std::memcpy(&bytes_[at], &value, sizeof value);
    }
  }

  soapfilm_array array_{};
  std::unique_ptr<char[]> bytes_;
};

struct Listener {
  soapfilm_context* context;
  size_t events_to_cancel;  ///< 0: never
};

void on_event(void* user, soapfilm_event event, double fraction, const char* text) {
  auto* listener = static_cast<Listener*>(user);
  require(event >= SOAPFILM_STAGE && event <= SOAPFILM_WARNING, "events are those of the header");
  require(fraction >= 0 && fraction <= 1, "a fraction lies in [0, 1]");
  if (event == SOAPFILM_WARNING) require_one_line(text);
  if (listener->events_to_cancel > 0 && --listener->events_to_cancel == 0) soapfilm_cancel(listener->context);
}

/// Values for each parameter that a tiny run may have; the first ones are usual.
std::string parameters(Decisions& next) {
  const auto one_of = [&next](std::initializer_list<const char*> values) {
    return std::string(values.begin()[next.below(values.size())]);
  };
  std::string json = "{\"place\": {\"resolution\": " + std::to_string(3 + next.below(22)) +
                     ", \"padding\": " + one_of({"2", "3", "2", "1"}) + ", \"levels\": " + one_of({"0", "1", "2"}) +
                     "}, \"solve\": {\"max_iterations\": 60, \"method\": \"" +
                     one_of({"tv", "tv", "tv-sor", "poisson", "graph-cut-6", "graph-cut-26", "vrip", "?"}) + "\"}";
  const auto maybe = [&](const char* group, const char* name, std::initializer_list<const char*> values) {
    if (next.one_in(4)) json += std::string(", \"") + group + "\": {\"" + name + "\": " + one_of(values) + "}";
  };
  maybe("energy", "lambda", {"0.1", "1e-6", "1e24", "-1", "1"});
  maybe("border", "outside", {"\"air\"", "\"solid\"", "\"open\"", "\"automatic\""});
  maybe("orient", "directions", {"\"normals\"", "\"sensor\"", "\"scan\"", "\"estimate\"", "3"});
  maybe("surface", "attributes", {"[\"all\"]", "[]", "[\"color\", \"a\"]", "[\"b\"]"});
  maybe("surface", "refine", {"true", "false", "null"});
  maybe("surface", "threshold", {"0.5", "0.01", "0.99", "1"});
  maybe("refine", "smoothing", {"1", "1e-6", "1e6"});
  maybe("refine", "normals", {"0", "1e6"});
  maybe("trim", "on", {"true", "false"});
  maybe("trim", "distance", {"1", "1e-9", "1e300"});
  maybe("components", "min_support", {"0", "1", "1e9"});
  maybe("memory", "limit", {"1", "100000000", "-1"});
  json += "}";
  if (next.one_in(32)) json.resize(next.below(json.size()));
  return json;
}

class Caller {
 public:
  Caller(const uint8_t* data, size_t size) : next_(data, size) { renew_context(); }
  ~Caller() {
    for (soapfilm_result* result : results_) soapfilm_result_destroy(result);
    soapfilm_cloud_destroy(cloud_);
    soapfilm_context_destroy(context_);
  }
  Caller(const Caller&) = delete;
  Caller& operator=(const Caller&) = delete;

  void run() {
    for (int runs = 0, calls = 0; calls < 24 && runs < 3 && !next_.at_end(); ++calls) {
      switch (next_.below(12)) {
        case 0:
        case 1:
        case 2:
        case 3:
          append();
          break;
        case 4:
        case 5:
          ++runs;
          reconstruct();
          break;
        case 6:
          listen();
          break;
        case 7:
          soapfilm_cancel(context_);
          break;
        case 8:
          write();
          break;
        case 9:
          renew_cloud();
          break;
        case 10:
          renew_context();
          break;
        default:
          check(soapfilm_cloud_read(context_, cloud_, next_.below(2) == 0 ? "missing.ply" : ""));
      }
    }
    if (soapfilm_cloud_size(cloud_) > 0) reconstruct();
  }

 private:
  soapfilm_status check(soapfilm_status status) const {
    require(status >= SOAPFILM_OK && status < SOAPFILM_FAILED, std::string("no fault: ") + soapfilm_error(context_));
    if (status != SOAPFILM_OK) require_one_line(soapfilm_error(context_));
    return status;
  }

  void renew_context() {
    soapfilm_context_destroy(context_);
    context_ = soapfilm_context_create(1);
    require(context_, "a context is made");
    require(soapfilm_error(context_)[0] == '\0', "a new context has no error");
  }

  void renew_cloud() {
    soapfilm_cloud_destroy(cloud_);
    cloud_ = soapfilm_cloud_create();
    require(cloud_ && soapfilm_cloud_size(cloud_) == 0, "a new cloud is empty");
  }

  void listen() {
    listener_ = {context_, next_.below(256)};
    soapfilm_on_event(context_, next_.one_in(4) ? nullptr : on_event, &listener_);
  }

  /// Samples of a sphere, which give a surface, or any.
  void append() {
    const size_t count = next_.below(61 - std::min<size_t>(60, soapfilm_cloud_size(cloud_)));
    const bool sphere = next_.below(2) == 0;
    std::vector<double> ball;
    for (size_t i = 0; sphere && i < count; ++i) {
      const double z = 1 - (2.0 * static_cast<double>(i) + 1) / static_cast<double>(count);
      const double a = 2.399963 * static_cast<double>(i), r = std::sqrt(1 - z * z);
      for (const double v : {r * std::cos(a), r * std::sin(a), z}) ball.push_back(v);
    }
    const OwnArray position(next_, sphere ? 0 : count, 3, false), normal(next_, sphere ? 0 : count, 3, false),
        sensor(next_, count, 3, false), weight(next_, count, 1, false), color(next_, count, 3, true),
        first(next_, count, 1, false), second(next_, count, 1, false);
    soapfilm_samples samples = {};
    samples.count = count;
    samples.position = samples.normal = {ball.data(), SOAPFILM_FLOAT64, 0};
    if (!sphere) {
      samples.position = position.array();
      samples.normal = normal.array();
    }
    if (next_.one_in(3)) samples.sensor = sensor.array();
    if (next_.one_in(3)) samples.weight = weight.array();
    if (next_.one_in(3)) samples.color = color.array();
    const std::array<double, 3> scanner{number(next_), number(next_), number(next_)};
    if (next_.one_in(3)) samples.scanner = scanner.data();
    const std::string name = next_.text(6);
    if (next_.one_in(3)) samples.name = name.c_str();
    const std::array<soapfilm_column, 2> columns{
        {{"a", first.array(), 0}, {next_.one_in(8) ? "a" : "b", second.array(), 1}}};
    samples.columns = columns.data();
    samples.column_count = next_.below(3);
    const size_t before = soapfilm_cloud_size(cloud_);
    const bool appended = check(soapfilm_cloud_append(context_, cloud_, &samples)) == SOAPFILM_OK;
    require(soapfilm_cloud_size(cloud_) == before + (appended ? count : 0), "appended whole or not at all");
  }

  void reconstruct() {
    soapfilm_result* result = nullptr;
    const std::string json = parameters(next_);
    const bool done = check(soapfilm_reconstruct(context_, cloud_, json.c_str(), &result)) == SOAPFILM_OK;
    require(done == (result != nullptr), "a result only if it did not fail");
    if (!done) return;
    check_result(result);
    soapfilm_result_destroy(results_[0]);
    results_[0] = results_[1];
    results_[1] = result;
  }

  static void check_result(const soapfilm_result* result) {
    const size_t vertices = soapfilm_vertex_count(result), triangles = soapfilm_triangle_count(result);
    require(vertices > 0 && triangles > 0, "a result has a surface");
    for (size_t i = 0; i < 3 * vertices; ++i)
      require(std::isfinite(soapfilm_vertices(result)[i]), "vertices are finite");
    for (size_t i = 0; i < 3 * triangles; ++i)
      require(soapfilm_triangles(result)[i] < vertices, "triangles name vertices");
    require(std::strlen(soapfilm_report(result)) > 0, "a result has a report");
    unsigned sum = 0;
    if (const uint8_t* colors = soapfilm_colors(result))
      for (size_t i = 0; i < 3 * vertices; ++i) sum += colors[i];
    for (size_t k = 0; const char* name = soapfilm_attribute_name(result, k); ++k) {
      const float* values = soapfilm_attribute(result, name);
      require(values, "an attribute that has a name has values");
      for (size_t i = 0; i < vertices; ++i) sum += std::isnan(values[i]);
    }
    require(!soapfilm_attribute(result, "no such"), "no attribute without a name");
    [[maybe_unused]] static volatile unsigned sink;  // every byte is read
    sink = sum;
  }

  void write() {
    const soapfilm_result* result = results_[1];
    if (!result) return;
    constexpr std::array<const char*, 5> paths{"/dev/null/mesh.ply", "mesh.none", "", "fuzzed.ply", "fuzzed.obj"};
    check(soapfilm_write_mesh(context_, result, paths[next_.below(paths.size())]));
  }

  Decisions next_;
  soapfilm_context* context_ = nullptr;
  soapfilm_cloud* cloud_ = soapfilm_cloud_create();
  std::array<soapfilm_result*, 2> results_{};
  Listener listener_{};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Caller(data, size).run();
  return 0;
}
