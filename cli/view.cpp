// soapfilm view: meshes and samples as a page for the browser.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <system_error>
#include <variant>
#include <vector>

#include "cli/browser.h"
#include "cli/command.h"
#include "cli/overwrite.h"
#include "cli/print.h"
#include "cli/read_cloud.h"
#include "cli/terminal.h"
#include "soapfilm/core/printable.h"
#include "soapfilm/core/stages.h"
#include "soapfilm/error.h"
#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/files.h"
#include "soapfilm/io/formats.h"
#include "soapfilm/io/sets/input_files.h"
#include "tools/view/view.h"

namespace soapfilm::cli {

namespace {

namespace fs = std::filesystem;

struct ViewOptions {
  std::vector<std::string> files;
  std::vector<std::string> reports;
  std::string html;
  std::string up;
  std::string columns;
  ViewParams params;
};

struct ReadItem {
  std::variant<Mesh, PointCloud> shape;
  std::string report;
};

/// Text of a report, or of nothing that is one: "".
std::string report_text(const std::string& path) {
  constexpr size_t longest_report = size_t{64} << 20;
  const io::ByteSource file(path);
  if (file.bytes().size() > longest_report) return "";
  std::string text(file.bytes());
  const auto json = nlohmann::json::parse(text, nullptr, false);
  return json.is_object() && json.contains("parameters") ? text : "";
}

std::string required_report(const std::string& path) {
  std::string text = report_text(path);
  if (text.empty()) throw InputError(fmt::format("{}: is no report, must be what reconstruct --report writes", path));
  return text;
}

/// NAME.report.json beside the mesh; "" if there is none.
std::string report_beside(const std::string& mesh) { return fs::path(mesh).replace_extension(".report.json").string(); }

std::string report_of(const ViewOptions& options, const std::string& mesh, size_t number, Progress& progress) {
  if (number < options.reports.size()) return required_report(options.reports[number]);
  const std::string beside = report_beside(mesh);
  std::error_code unreadable;
  if (!fs::is_regular_file(beside, unreadable)) return "";
  std::string text = report_text(beside);
  if (text.empty()) progress.warn(fmt::format("{}: is no report of reconstruct, not shown", beside));
  return text;
}

bool takes_columns(const std::string& path) {
  std::vector<std::string> told_later;
  const std::vector<std::string> files = io::input_files({path}, told_later);
  return std::any_of(files.begin(), files.end(), [](const std::string& file) {
    const io::Format* format = io::format_of(io::ByteSource(file));
    return format && format->takes("columns");
  });
}

std::vector<ReadItem> read_items(const ViewOptions& options, const Context& context) {
  std::vector<ReadItem> items;
  size_t meshes = 0;
  for (const std::string& path : options.files) {
    if (file_kind(path) == FileKind::mesh) {
      items.push_back({read_mesh(path), report_of(options, path, meshes++, context.progress())});
    } else {
      ReadReport read;
      ReadOptions as;
      if (takes_columns(path)) as.columns = options.columns;
      items.push_back({read_cloud({path}, as, context, read), ""});
      std::vector<std::string> scans;  // of a set
      for (const FileReport& file : read.files) scans.push_back(file.path);
      refuse_overwriting({options.html}, scans);
    }
  }
  if (!options.columns.empty() && std::none_of(options.files.begin(), options.files.end(), takes_columns))
    throw ParameterError(fmt::format("--columns: none of the files takes it, such as {}", options.files[0]));
  if (meshes < options.reports.size()) {
    throw ParameterError(fmt::format("--report is given {} times, must be at most once for each of the {} meshes",
                                     options.reports.size(), meshes));
  }
  return items;
}

/// Maps and scans of buildings have their z upward; so have files with a coordinate system.
UpAxis up_of(const ViewOptions& options, const std::vector<ReadItem>& items) {
  if (!options.up.empty()) return options.up == "z" ? UpAxis::z : UpAxis::y;
  const auto is_georeferenced = [](const ReadItem& item) {
    if (const auto* cloud = std::get_if<PointCloud>(&item.shape)) return !cloud->coordinate_system.empty();
    if (item.report.empty()) return false;
    const auto report = nlohmann::json::parse(item.report, nullptr, false);
    const nlohmann::json::json_pointer place("/input/coordinate_system");
    return report.contains(place) && report[place].is_string() && report[place] != "";
  };
  return std::any_of(items.begin(), items.end(), is_georeferenced) ? UpAxis::z : UpAxis::y;
}

/// The files' names without folders, unless two of them would be alike.
std::vector<std::string> item_names(const std::vector<std::string>& files) {
  std::vector<std::string> names;
  for (const std::string& file : files) names.push_back(named_path(file).filename().string());
  std::vector<std::string> sorted = names;
  std::sort(sorted.begin(), sorted.end());
  return std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end() ? names : files;
}

/// False for a file of somebody else.
bool is_our_page(const std::string& path) {
  std::array<char, 256> head{};
  std::ifstream(path, std::ios::binary).read(head.data(), head.size() - 1);
  return std::string_view(head.data()).find("content=\"soapfilm view\"") != std::string_view::npos;
}

/// NAME.html beside the first file, or in the folder for temporary files where nothing can be written there.
std::string default_page(const std::string& first) {
  fs::path beside = first;
  std::error_code unreadable;
  if (fs::is_directory(first, unreadable))
    (beside = named_path(first)) += ".html";
  else
    beside.replace_extension(".html");
  std::string page = beside.string();
  try {
    check_output(page);
  } catch (const OutputError&) {
    page = (fs::temp_directory_path() / beside.filename()).string();
  }
  if (fs::exists(page, unreadable) && !is_our_page(page))
    throw OutputError(fmt::format("{}: exists and is no page of soapfilm view, name another one with --html", page));
  return page;
}

void check_places(const ViewOptions& options) {
  check_output(options.html);
  std::vector<std::string> inputs = options.files;
  inputs.insert(inputs.end(), options.reports.begin(), options.reports.end());
  for (const std::string& file : options.files) inputs.push_back(report_beside(file));
  refuse_overwriting({options.html}, inputs);
}

int run(ViewOptions options, const GlobalOptions& global) {
  if (!has_viewer()) viewer_page({}, {}, Context(1));  // says how to get one
  options.files = io::without_patterns(options.files);
  const bool open = options.html.empty();
  if (open) options.html = default_page(options.files[0]);
  check_places(options);
  TerminalProgress progress(global);
  const Context context(global.threads, progress);
  Stages stages(context);
  const std::vector<ReadItem> read = stages.run("read", [&] { return read_items(options, context); });
  options.params.up = up_of(options, read);
  const std::vector<std::string> names = item_names(options.files);
  std::vector<ViewItem> items(read.size());
  for (size_t i = 0; i < read.size(); ++i) {
    std::visit([&](const auto& shape) { items[i].shape = &shape; }, read[i].shape);
    items[i].name = names[i];
    items[i].report = read[i].report;
  }
  const std::string page = stages.run("page", [&] { return viewer_page(items, options.params, context); });
  stages.run("write", [&] { write_text_file(options.html, page); });
  const bool opened = open && open_in_browser(options.html);
  const double mib = static_cast<double>(page.size()) / (1 << 20);
  if (!global.quiet || !opened)
    print(stdout, fmt::format("{}: {:.1f} MiB, {}\n", printable(options.html), mib,
                              opened ? "opened in the browser" : "open it in a browser"));
  return 0;
}

}  // namespace

void add_view(CLI::App& app, const GlobalOptions& global, Runner& runner) {
  auto options = std::make_shared<ViewOptions>();
  ViewParams& params = options->params;
  CLI::App* command = app.add_subcommand("view", "Show meshes and point clouds in the browser: a page in one file");
  command
      ->add_option(
          "FILE", options->files,
          fmt::format("Meshes ({}) and clouds ({}), a folder is the scans in it; two stand side by side at first",
                      mesh_extensions(), point_extensions()))
      ->required()
      ->option_text("...");
  command
      ->add_option("--html", options->html,
                   "Write the page here and open no browser (default: NAME.html beside the first file,\nopened where "
                   "there is a desktop)")
      ->option_text("FILE");
  command
      ->add_option("--report", options->reports,
                   "Report of a mesh, shown beside it; given again for the next mesh (default:\nNAME.report.json "
                   "beside the mesh, if there is one)")
      ->allow_extra_args(false)
      ->option_text("FILE");
  command->add_option("--title", params.title, "Title of the page (default: names of the files)")->option_text("TEXT");
  command->add_option("--unit", params.unit, "Unit of the files' lengths, such as m; it is only shown")
      ->option_text("NAME");
  command
      ->add_option("--up", options->up, "Upright axis at first (default: z for files with a coordinate system, else y)")
      ->check(CLI::IsMember({"y", "z"}))
      ->option_text("AXIS");
  command
      ->add_option("--triangles", params.triangles,
                   "Of a mesh at most about so many: larger ones are simplified for the page; 0: all")
      ->check(CLI::Range(size_t{0}, size_t{1} << 32))
      ->option_text(fmt::format("N [{}]", params.triangles));
  command->add_option("--samples", params.samples, "Of a cloud at most so many: larger ones are thinned; 0: all")
      ->check(CLI::Range(size_t{0}, size_t{1} << 32))
      ->option_text(fmt::format("N [{}]", params.samples));
  command->add_option("--columns", options->columns, "Of text files: what their columns are, such as x,y,z,-,nx,ny,nz")
      ->option_text("NAMES");
  command->callback([options, &global, &runner] { runner = [options, &global] { return run(*options, global); }; });
}

}  // namespace soapfilm::cli
