// soapfilm info FILE...: what is in a file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "cli/coordinate_system.h"
#include "cli/print.h"
#include "cli/read_cloud.h"
#include "cli/standard_streams.h"
#include "soapfilm/core/json_text.h"
#include "soapfilm/core/printable.h"
#include "soapfilm/io.h"
#include "soapfilm/io/files.h"
#include "soapfilm/io/formats.h"
#include "soapfilm/io/precision.h"
#include "soapfilm/io/sets/input_files.h"
#include "soapfilm/io/summary.h"
#include "soapfilm/mesh/topology.h"
#include "tools/mesh/json.h"

namespace soapfilm::cli {

namespace {

using nlohmann::ordered_json;

struct InfoOptions {
  std::vector<std::string> files;
  ReadOptions read;
  std::string format;  ///< of standard input
  bool as_json = false;
};

ordered_json scan_facts(const ScanSummary& scan) {
  ordered_json facts = {{"name", scan.name}, {"samples", scan.samples}};
  if (scan.sensor) facts["sensor"] = json_of(*scan.sensor);
  if (scan.view_direction) facts["view_direction"] = json_of(*scan.view_direction);
  if (scan.grid)
    facts["range_grid"] = {{"columns", scan.grid->columns}, {"rows", scan.grid->rows}, {"samples", scan.grid->samples}};
  return facts;
}

/// Of the coordinates; empty: the file does not say.
std::string unit_of(const std::string& coordinate_system, const ReadReport& report) {
  if (!coordinate_system.empty()) return coordinate_system_of(coordinate_system).unit;
  const auto in_meters = [](const FileReport& file) { return file.format.starts_with("E57"); };
  return std::all_of(report.files.begin(), report.files.end(), in_meters) ? "meter" : "";
}

ordered_json point_facts(const std::string& path, const ReadOptions& options, const Context& context) {
  ReadReport report;
  SummarySink sink;
  stream_points(path, sink, report, options, context);
  const CloudSummary summary = sink.summary();
  ordered_json facts = {{"file", path},
                        {"kind", "points"},
                        {"samples", summary.samples},
                        {"dropped_non_finite", report.dropped()},
                        {"no_return", no_returns(report)},
                        {"box", json_of(summary.box)},
                        {"size", json_of(summary.box.size())},
                        {"spacing", summary.spacing},
                        {"normals", summary.normals},
                        {"sensor_positions", summary.sensors},
                        {"scans_with_sensor", summary.scans_with_sensor},
                        {"scans_with_view_direction", summary.scans_with_view_direction},
                        {"scans_with_range_grid", summary.scans_with_range_grid},
                        {"weights", summary.weights},
                        {"colors", summary.colors},
                        {"columns", summary.columns},
                        {"scans", ordered_json::array()},
                        {"warnings", report.warnings}};
  if (!summary.coordinate_system.empty()) facts["coordinate_system"] = summary.coordinate_system;
  facts["unit"] = unit_of(summary.coordinate_system, report);
  std::vector<std::string> formats;  // each once, in order
  std::vector<std::string> properties;
  const auto add = [](std::vector<std::string>& to, const std::string& name) {
    if (std::find(to.begin(), to.end(), name) == to.end()) to.push_back(name);
  };
  for (const FileReport& file : report.files) {
    add(formats, file.format);
    for (const std::string& property : file.properties) add(properties, property);
  }
  facts["format"] = fmt::format("{}", fmt::join(formats, "; "));
  facts["properties"] = properties;
  for (const ScanSummary& scan : summary.scans) facts["scans"].push_back(scan_facts(scan));
  return facts;
}

ordered_json mesh_facts(const std::string& path) {
  ReadReport report;
  const Mesh mesh = read_mesh(path, &report);
  const TopologyReport topology = check_topology(mesh);
  const Box3d box = mesh.box();
  ordered_json facts = {{"file", path},
                        {"kind", "mesh"},
                        {"vertices", mesh.vertices.size()},
                        {"triangles", mesh.triangles.size()},
                        {"box", json_of(box)},
                        {"size", json_of(box.size())},
                        {"mean_edge", io::mean_edge(mesh)},
                        {"area", mesh.area()},
                        {"volume", topology.closed() ? ordered_json(mesh.volume()) : ordered_json(nullptr)},
                        {"normals", !mesh.normals.empty()},
                        {"colors", !mesh.colors.empty()},
                        {"attributes", ordered_json::array()},
                        {"warnings", report.warnings}};
  facts["closed"] = topology.closed();
  facts["manifold"] = topology.manifold();
  facts["boundary_edges"] = topology.boundary_edges;
  facts["components"] = topology.components.size();
  if (const auto genus = topology.genus()) facts["genus"] = *genus;
  for (const Column& attribute : mesh.attributes) {
    std::vector<float> values;  // a vertex may have none: not a number
    std::copy_if(attribute.values.begin(), attribute.values.end(), std::back_inserter(values),
                 [](float value) { return std::isfinite(value); });
    const auto [lo, hi] = std::minmax_element(values.begin(), values.end());
    facts["attributes"].push_back({{"name", attribute.name},
                                   {"lo", values.empty() ? ordered_json(nullptr) : ordered_json(*lo)},
                                   {"hi", values.empty() ? ordered_json(nullptr) : ordered_json(*hi)}});
  }
  return facts;
}

/// 1234567 as "1,234,567".
std::string grouped(size_t value) {
  std::string digits = fmt::format("{}", value);
  for (size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, ",");
  return digits;
}
std::string grouped(const ordered_json& value) { return grouped(value.get<size_t>()); }

/// Three numbers with enough digits to show `resolution`.
std::string triple(const ordered_json& v, double resolution) {
  const int digits = resolution > 0 ? std::clamp(static_cast<int>(std::ceil(-std::log10(resolution))), 0, 12) : 6;
  const double invisible = 0.5 * std::pow(10.0, -digits);
  const auto text = [&](const ordered_json& number) {
    const double value = number;
    return fmt::format("{:.{}f}", std::abs(value) < invisible ? 0.0 : value, digits);  // no "-0.00"
  };
  return text(v[0]) + "  " + text(v[1]) + "  " + text(v[2]);
}

using Lines = std::vector<std::pair<std::string, std::string>>;

void print_lines(const Lines& lines) {
  size_t width = 0;
  for (const auto& line : lines) width = std::max(width, line.first.size());
  for (const auto& [label, text] : lines) print(stdout, fmt::format("  {:<{}}  {}\n", label, width, printable(text)));
}

void add_box(Lines& lines, const ordered_json& facts, double resolution) {
  lines.emplace_back("box from", triple(facts["box"]["lo"], resolution));
  lines.emplace_back("to", triple(facts["box"]["hi"], resolution));
  lines.emplace_back("size", triple(facts["size"], resolution));
}

/// Where `--directions auto` can take directions from, in its order of preference.
std::string direction_sources(const ordered_json& facts) {
  std::vector<std::string> sources;
  const size_t scans = facts["scans"].size();
  if (facts["normals"] > 0) sources.push_back(fmt::format("normals of {} samples", grouped(facts["normals"])));
  if (facts["sensor_positions"] > 0)
    sources.push_back(fmt::format("sensor positions of {} samples", grouped(facts["sensor_positions"])));
  if (facts["scans_with_sensor"] > 0)
    sources.push_back(
        fmt::format("sensor position of {} of {} scans", facts["scans_with_sensor"].get<size_t>(), scans));
  if (facts["scans_with_view_direction"] > 0)
    sources.push_back(
        fmt::format("viewing direction of {} of {} scans", facts["scans_with_view_direction"].get<size_t>(), scans));
  return sources.empty() ? "none: they would be estimated" : fmt::format("{}", fmt::join(sources, "; "));
}

void print_scans(const ordered_json& scans, double spacing) {
  size_t name_width = 4;
  for (const ordered_json& scan : scans)
    name_width = std::max(name_width, scan["name"].get_ref<const std::string&>().size());
  print(stdout, fmt::format("\n  {:<{}}  {:>11}  {:>11}  {:>6}  {}\n", "scan", name_width, "samples", "range grid",
                            "filled", "seen from"));
  for (const ordered_json& scan : scans) {
    std::string grid = "-";
    std::string filled = "-";
    if (scan.contains("range_grid")) {
      const ordered_json& cells = scan["range_grid"];
      const double columns = cells["columns"];
      const double rows = cells["rows"];
      grid = fmt::format("{} x {}", columns, rows);
      filled = fmt::format("{:.0f} %", 100.0 * cells["samples"].get<double>() / (columns * rows));
    }
    std::string seen = "-";
    if (scan.contains("sensor"))
      seen = "position  " + triple(scan["sensor"], spacing);
    else if (scan.contains("view_direction"))
      seen = "direction  " + triple(scan["view_direction"], 1e-3);
    print(stdout, fmt::format("  {:<{}}  {:>11}  {:>11}  {:>6}  {}\n", printable(scan["name"]), name_width,
                              grouped(scan["samples"]), grid, filled, seen));
  }
}

void print_points(const ordered_json& facts) {
  const double spacing = facts["spacing"];
  Lines lines{{"kind", fmt::format("points ({})", facts["format"].get<std::string>())},
              {"samples", grouped(facts["samples"])}};
  if (facts["dropped_non_finite"] > 0)
    lines.emplace_back("dropped", grouped(facts["dropped_non_finite"]) + " with a non-finite coordinate");
  if (facts["no_return"] > 0) lines.emplace_back("no return", grouped(facts["no_return"]) + " rays, dropped");
  lines.emplace_back("properties",
                     fmt::format("{}", fmt::join(facts["properties"].get<std::vector<std::string>>(), " ")));
  add_box(lines, facts, 0.1 * spacing);
  lines.emplace_back("spacing", fmt::format("{:.3g} (estimated distance of neighboring samples)", spacing));
  lines.emplace_back("directions", direction_sources(facts));
  lines.emplace_back("weights", facts["weights"].get<bool>() ? "yes" : "no");
  lines.emplace_back("colors", facts["colors"].get<bool>() ? "yes" : "no");
  if (!facts["columns"].empty())
    lines.emplace_back("columns", fmt::format("{}", fmt::join(facts["columns"].get<std::vector<std::string>>(), " ")));
  if (facts.contains("coordinate_system"))
    lines.emplace_back("coordinates",
                       coordinate_system_of(facts["coordinate_system"].get_ref<const std::string&>()).name);
  const std::string unit = facts["unit"];
  lines.emplace_back("unit", unit.empty() ? "not said" : unit);
  lines.emplace_back("scans", grouped(facts["scans"].size()));
  print_lines(lines);
  print_scans(facts["scans"], 0.1 * spacing);
}

/// "closed, manifold, 1 component, genus 0".
std::string surface_text(const ordered_json& facts) {
  const size_t components = facts["components"];
  std::string text =
      facts["closed"] ? "closed" : fmt::format("open ({} boundary edges)", grouped(facts["boundary_edges"]));
  text += facts["manifold"] ? ", manifold" : ", not manifold";
  text += fmt::format(", {} component{}", grouped(components), components == 1 ? "" : "s");
  if (facts.contains("genus")) text += fmt::format(", genus {}", facts["genus"].get<int64_t>());
  return text;
}

void print_mesh(const ordered_json& facts) {
  Lines lines{{"kind", "mesh"}, {"vertices", grouped(facts["vertices"])}, {"triangles", grouped(facts["triangles"])}};
  const double edge = facts["mean_edge"];
  add_box(lines, facts, 0.1 * edge);
  lines.emplace_back("mean edge", fmt::format("{:.3g}", edge));
  lines.emplace_back("area", fmt::format("{:.6g}", facts["area"].get<double>()));
  lines.emplace_back("surface", surface_text(facts));
  if (!facts["volume"].is_null())
    lines.emplace_back("volume", fmt::format("{:.6g}{}", facts["volume"].get<double>(),
                                             facts["volume"] < 0 ? " (the surface is inside out)" : ""));
  lines.emplace_back("normals", facts["normals"].get<bool>() ? "yes" : "no");
  lines.emplace_back("colors", facts["colors"].get<bool>() ? "yes" : "no");
  for (const ordered_json& attribute : facts["attributes"]) {
    const std::string name = attribute["name"];
    lines.emplace_back("attribute", attribute["lo"].is_null()
                                        ? name + " without a value"
                                        : fmt::format("{} from {:.4g} to {:.4g}", name, attribute["lo"].get<float>(),
                                                      attribute["hi"].get<float>()));
  }
  print_lines(lines);
}

int run_info(InfoOptions& options) {
  const Context context;
  StandardStreams streams(options.format, context);
  streams.take_input(options.files);
  options.files = io::without_patterns(options.files);
  ordered_json all = ordered_json::array();
  for (const std::string& path : options.files) {
    const ordered_json facts =
        file_kind(path) == FileKind::mesh ? mesh_facts(path) : point_facts(path, options.read, context);
    if (options.as_json) {
      all.push_back(facts);
      continue;
    }
    print(stdout, fmt::format("{}{}\n", path == options.files.front() ? "" : "\n", printable(with_known_names(path))));
    if (facts["kind"] == "mesh")
      print_mesh(facts);
    else
      print_points(facts);
    for (const ordered_json& warning : facts["warnings"])
      print(stdout, fmt::format("  warning: {}\n", printable(with_known_names(warning.get<std::string>()))));
  }
  if (options.as_json) print(stdout, with_known_names(json_text(all)) + "\n");
  return 0;
}

}  // namespace

void add_info(CLI::App& app, const GlobalOptions& /*options*/, Runner& runner) {
  CLI::App* command = app.add_subcommand("info", "Print what is in a file: samples, box, spacing, directions, scans");
  auto options = std::make_shared<InfoOptions>();
  command
      ->add_option(
          "files", options->files,
          "Point clouds, scan sets or meshes; a folder is the scans in it, a pattern such as\n'tiles/*.laz' the files "
          "that it matches, - standard input")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--format", options->format, "Of standard input, such as las (default: by how it begins, or text)")
      ->option_text("EXT");
  command->add_flag("--json", options->as_json, "Print a JSON array, one object per file");
  add_read_options(*command, options->read);
  command->callback([options, &runner] { runner = [options] { return run_info(*options); }; });
}

}  // namespace soapfilm::cli
