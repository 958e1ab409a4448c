#include "cases.h"

#include <fmt/format.h>

#include <cstring>

#include "nasty_cloud.h"

namespace soapfilm::test {

namespace {

/// PLY with all of the cloud's columns in double, as text or little-endian.
class PlyFile {
 public:
  PlyFile(const NastyCloud& cloud, bool ascii) : cloud_(cloud), ascii_(ascii) {
    header();
    for (size_t i = 0; i < cloud.positions.size(); ++i) row(i);
    for (const int s : cloud.grid) cell(s);
  }
  std::string bytes() { return std::move(bytes_); }

 private:
  void header() {
    bytes_ = fmt::format("ply\nformat {} 1.0\n", ascii_ ? "ascii" : "binary_little_endian");
    const auto sensor = [&] {
      const Vec3d s = cloud_.sensor;
      if (cloud_.scan_sensor) bytes_ += fmt::format("comment sensor {} {} {}\n", s.x, s.y, s.z);
    };
    for (const size_t samples : cloud_.scans) {
      bytes_ += fmt::format("comment scan_samples {}\n", samples);
      sensor();
    }
    if (cloud_.scans.empty()) sensor();
    if (cloud_.columns > 0)
      bytes_ += fmt::format("obj_info num_cols {}\nobj_info num_rows {}\n", cloud_.columns, cloud_.rows);
    bytes_ += fmt::format("element vertex {}\n", cloud_.positions.size());
    properties(true, "double", {"x", "y", "z"});
    properties(!cloud_.normals.empty(), "double", {"nx", "ny", "nz"});
    properties(!cloud_.sensors.empty(), "double", {"sensor_x", "sensor_y", "sensor_z"});
    properties(!cloud_.weights.empty(), "double", {"weight"});
    properties(!cloud_.colors.empty(), "uchar", {"red", "green", "blue"});
    properties(!cloud_.values.empty(), "double", {"intensity"});
    if (!cloud_.grid.empty())
      bytes_ += fmt::format("element range_grid {}\nproperty list uchar int vertex_indices\n", cloud_.grid.size());
    bytes_ += "end_header\n";
  }
  void properties(bool given, const char* type, std::initializer_list<const char*> names) {
    if (!given) return;
    for (const char* name : names) bytes_ += fmt::format("property {} {}\n", type, name);
  }

  void row(size_t i) {
    for (const auto* column : {&cloud_.positions, &cloud_.normals, &cloud_.sensors})
      if (!column->empty())
        for (const double v : {(*column)[i].x, (*column)[i].y, (*column)[i].z}) put(v);
    if (!cloud_.weights.empty()) put(cloud_.weights[i]);
    if (!cloud_.colors.empty())
      for (const int c : cloud_.colors[i]) put(static_cast<uint8_t>(c));
    if (!cloud_.values.empty()) put(cloud_.values[i]);
    if (ascii_) bytes_ += '\n';
  }
  void cell(int sample) {
    put(static_cast<uint8_t>(sample >= 0));
    if (sample >= 0) put(sample);
    if (ascii_) bytes_ += '\n';
  }

  template <class T>
  void put(T value) {
    if (ascii_) {
      bytes_ += fmt::format("{} ", value);
    } else {
      char raw[sizeof(T)];
      std::memcpy(raw, &value, sizeof(T));
      bytes_.append(raw, sizeof(T));
    }
  }

  const NastyCloud& cloud_;
  bool ascii_;
  std::string bytes_;
};

std::string text_file(const NastyCloud& cloud) {
  std::string text;
  for (size_t i = 0; i < cloud.positions.size(); ++i) {
    const Vec3d p = cloud.positions[i];
    text += fmt::format("{} {} {}", p.x, p.y, p.z);
    if (!cloud.normals.empty())
      text += fmt::format(" {} {} {}", cloud.normals[i].x, cloud.normals[i].y, cloud.normals[i].z);
    text += '\n';
  }
  return text;
}

/// Most options fit the method; the others must be refused.
class Options {
 public:
  /// `grid`: the cloud has a range grid.
  Options(Chooser& choose, bool grid, DegenerateCase& to) : choose_(choose), grid_(grid), to_(to) {}

  void choose_all() {
    constexpr const char* methods[] = {"tv", "tv", "tv", "tv", "tv-sor", "poisson", "graph-cut-6", "graph-cut-26"};
    method_ = grid_ || choose_.one_in(40) ? "vrip" : choose_.of(methods);
    if (grid_ && choose_.one_in(2)) method_ = choose_.of(methods);
    add("--method", method_);
    const bool any = choose_.one_in(25);  // also options that the method does not have
    grid(any);
    energy(any);
    directions();
    surface(any);
    if (method_ == "vrip" || outside_ == "auto" || outside_ == "open" || trims_) to_.may_end = true;
  }

 private:
  void add(const std::string& name, const std::string& value = {}) {
    to_.options.push_back(name);
    if (!value.empty()) to_.options.push_back(value);
  }
  void maybe(size_t one_in, const std::string& name, const std::string& value = {}) {
    if (choose_.one_in(one_in)) add(name, value);
  }
  std::string power(double low, double high) { return fmt::format("{:.3e}", choose_.power(low, high)); }

  void grid(bool any) {
    const size_t padding = choose_.one_in(3) ? 2 + choose_.below(7) : 2 + choose_.below(2);
    const size_t fewest = choose_.one_in(30) ? 3 : 2 * padding + 2;
    const size_t span = choose_.one_in(30) ? 28 : choose_.one_in(4) ? 14 : 8;
    add("--resolution", std::to_string(std::min<size_t>(40, fewest + choose_.below(span))));
    add("--padding", std::to_string(padding));
    if (method_ == "tv") maybe(4, "--adapt", "on");
    constexpr const char* outsides[] = {"air", "air", "solid", "open"};
    if (!choose_.one_in(3)) return;
    outside_ = choose_.of(outsides);
    if (!any && method_ != "tv" && outside_ == "open") outside_ = "air";
    add("--outside", outside_);
  }

  void energy(bool any) {
    const bool has_energy = any || method_ == "tv" || method_ == "tv-sor" || method_.starts_with("graph");
    if (!has_energy) return;
    if (choose_.one_in(150)) {
      add("--lambda", "auto");
      add("--folds", "2");
      return;
    }
    constexpr const char* odd[] = {"1e-30", "1e-300", "1e24", "1e20", "0", "-1", "nan", "1e39"};
    if (choose_.one_in(30))
      add("--lambda", choose_.of(odd));
    else if (choose_.one_in(2))
      add("--lambda", power(-6, 0));
    else
      maybe(8, "--weights", "samples");
    if (any || method_ == "tv" || method_ == "graph-cut-6") maybe(6, "--norm", "anisotropic");
  }

  void directions() {
    constexpr const char* sources[] = {"normals", "sensor", "scan", "estimate"};
    if (choose_.one_in(4)) add("--directions", choose_.of(sources));
    maybe(10, "--sensor", choose_.one_in(10) ? "nan,0,0" : choose_.one_in(3) ? "0,0,0" : "3,2,9");
    maybe(10, "--neighbors", std::to_string(3 + choose_.below(30)));
    maybe(12, "--radius", power(-4, 3));
  }

  void surface(bool any) {
    const bool refinable = any || (method_ != "poisson" && method_ != "vrip");
    if (any || method_.starts_with("tv")) maybe(5, "--threshold", fmt::format("{:.3f}", choose_.uniform(0, 1)));
    if (refinable) maybe(3, "--refine", choose_.one_in(2) ? "on" : "off");
    if (refinable) maybe(6, "--drop-components", choose_.one_in(2) ? "on" : "off");
    if (any || method_ == "tv") {
      maybe(20, "--smoothing", power(-6, 6));
      maybe(20, "--split-tolerance", choose_.one_in(2) ? "0" : power(-8, 0));
      maybe(10, "--holes", "flat");
    }
    if (any || method_ != "vrip") {
      trims_ = choose_.one_in(5);
      if (trims_) add("--trim", choose_.one_in(2) ? "auto" : power(-3, 3));
      if (trims_) maybe(2, "--trim-holes");
    }
    maybe(4, "--distance");
    maybe(4, "--check");
    if (choose_.one_in(3)) add("--attributes", choose_.one_in(8) ? "none" : "all");
    to_.ascii = choose_.one_in(4);
    if (to_.ascii) add("--ascii");
    constexpr const char* tolerances[] = {"auto", "0.05vox", "0.5vox", "3vox"};
    if (choose_.one_in(4))
      add("--simplify", choose_.one_in(6) ? power(-6, 3) : choose_.of(tolerances));
    else
      maybe(20, "--triangles", std::to_string(1 + choose_.below(2000)));
  }

  Chooser& choose_;
  bool grid_;
  DegenerateCase& to_;
  std::string method_, outside_ = "auto";
  bool trims_ = false;
};

}  // namespace

DegenerateCase degenerate_case(uint64_t number) {
  Chooser choose(number * 0x9E3779B97F4A7C15ull + 1);
  DegenerateCase one;
  one.number = number;
  const NastyCloud cloud = nasty_cloud(choose);
  const bool text = choose.one_in(10);
  one.input = text ? "samples.xyz" : "samples.ply";
  one.bytes = text ? text_file(cloud) : PlyFile(cloud, choose.one_in(2)).bytes();
  constexpr const char* outputs[] = {"mesh.ply", "mesh.ply", "mesh.obj", "mesh.stl", "mesh.glb"};
  one.output = choose.of(outputs);
  Options(choose, cloud.columns > 0 && !text, one).choose_all();
  return one;
}

}  // namespace soapfilm::test
