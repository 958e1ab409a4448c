#include "soapfilm/io/e57/e57.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>

#include "soapfilm/error.h"
#include "soapfilm/io/e57/e57_head.h"
#include "soapfilm/io/e57/e57_layout.h"
#include "soapfilm/io/e57/e57_pages.h"
#include "soapfilm/io/e57/e57_records.h"
#include "soapfilm/io/e57/e57_scan.h"
#include "soapfilm/io/point_stream.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

/// All scans as one table: the fields of each and where they go.
struct E57Plan {
  std::vector<E57Layout> layouts;
  std::vector<std::vector<size_t>> column_of;  ///< of each scan's further fields, their columns in the cloud
  std::vector<E57Section> sections;
  PointHeader header;
  bool cells = false;
};

void add_e57_columns(const E57Layout& layout, const std::string& path, E57Plan& plan) {
  constexpr size_t most_columns = 1000;
  std::vector<std::string>& names = plan.header.columns;
  std::vector<size_t>& column_of = plan.column_of.emplace_back();
  for (const E57Layout::Further& further : layout.further) {
    const auto found = std::find(names.begin(), names.end(), further.name);
    column_of.push_back(static_cast<size_t>(found - names.begin()));
    if (found == names.end()) names.push_back(further.name);
  }
  if (names.size() > most_columns)
    throw InputError(fmt::format("{}: fields of more than {} different names", path, most_columns));
}

/// Sections that share bytes would let a small file ask for the same work many times.
void check_e57_sections(const E57Head& head, const E57Plan& plan, const E57Pages& pages) {
  std::vector<size_t> order(plan.sections.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](size_t a, size_t b) { return plan.sections[a].begin < plan.sections[b].begin; });
  for (size_t i = 1; i < order.size(); ++i) {
    const E57Section& before = plan.sections[order[i - 1]];
    const E57Section& after = plan.sections[order[i]];
    if (after.begin < before.end)
      pages.fail(after.begin,
                 fmt::format("points of {} begin within those of {}, must have a section of their own",
                             in_quotes(head.scans[order[i]].name), in_quotes(head.scans[order[i - 1]].name)));
  }
}

/// A few bits of a file can be a sample of many bytes; far more than real files have of this would be an attack.
void check_e57_growth(const E57Plan& plan, const E57Pages& pages) {
  constexpr uint64_t most_growth = 16, always = uint64_t{64} << 20;
  const PointHeader& header = plan.header;
  const uint64_t each = sizeof(Vec3d) + header.normals * sizeof(Vec3f) + header.sensors * sizeof(Vec3d) +
                        header.weights * sizeof(float) + header.colors * (sizeof(Rgb8) + sizeof(Vec3f)) +
                        header.columns.size() * sizeof(float) + plan.cells * 7 * sizeof(int32_t);
  const uint64_t most = (most_growth * pages.file_size() + always) / each;
  if (header.samples > most)
    throw InputError(
        fmt::format("{}: recordCount = {} in all, must be at most {}: {} bytes each from a file of {} bytes",
                    pages.path(), header.samples, most, each, pages.file_size()));
}

/// One warning, if there is something to warn of: what, and the first few.
void warn_of_e57(std::string_view what, const std::vector<std::string>& where, const std::string& path,
                 ReadReport& report) {
  constexpr size_t most = 8;
  if (where.empty()) return;
  std::string list;
  for (size_t i = 0; i < std::min(where.size(), most); ++i) list += (i == 0 ? "" : ", ") + where[i];
  if (where.size() > most) list += fmt::format(" and {} more", where.size() - most);
  report.warnings.push_back(fmt::format("{}: {}: {}", path, what, list));
}

/// As keep_attributes() of point_columns.h.
void keep_e57_attributes(const std::vector<std::string>& attributes, E57Layout& layout) {
  std::vector<std::string> names;
  PointColumns columns;
  for (const E57Layout::Further& further : layout.further) {
    columns.others.push_back(names.size());
    names.push_back(further.name);
  }
  columns.color = layout.color;
  keep_attributes(attributes, names, columns);
  std::vector<E57Layout::Further> kept;
  for (const size_t k : columns.others) kept.push_back(std::move(layout.further[k]));
  layout.further = std::move(kept);
  layout.color = columns.color;
}

E57Plan plan_e57(const E57Head& head, const std::vector<std::string>& attributes, E57Pages& pages, ReadReport& report) {
  E57Plan plan;
  std::vector<std::string> ignored;
  for (const E57Scan& scan : head.scans) {
    E57Layout layout = e57_layout(scan, pages.path(), ignored);
    keep_e57_attributes(attributes, layout);
    plan.sections.push_back(read_e57_section(pages, scan));
    add_e57_columns(layout, pages.path(), plan);
    PointHeader& header = plan.header;
    header.samples += scan.records;  // each at most what its section can hold, or refused below
    header.normals = header.normals || layout.normal.present();
    header.sensors = header.sensors || layout.sensor.present();
    header.weights = header.weights || layout.weight != Triple::absent;
    header.colors = header.colors || layout.color.present();
    plan.cells = plan.cells || layout.has_cells();
    plan.layouts.push_back(layout);
    check_e57_growth(plan, pages);
  }
  check_e57_sections(head, plan, pages);
  std::sort(ignored.begin(), ignored.end());
  ignored.erase(std::unique(ignored.begin(), ignored.end()), ignored.end());
  warn_of_e57("fields not used", ignored, pages.path(), report);
  return plan;
}

FileReport describe_e57(const E57Head& head, const std::string& path) {
  FileReport file;
  file.path = path;
  file.format = head.scans.size() == 1 ? "E57" : fmt::format("E57, {} scans", head.scans.size());
  std::set<std::string_view> known;
  for (const E57Scan& scan : head.scans)
    for (const E57Field& field : scan.fields)
      if (known.insert(field.name).second) file.properties.push_back(field.name);
  return file;
}

/// Coordinates of 24 bits that no pose moves far away.
bool e57_float32(const E57Head& head, const E57Plan& plan) {
  for (size_t s = 0; s < head.scans.size(); ++s) {
    const E57Scan& scan = head.scans[s];
    if (plan.layouts[s].spherical || (scan.pose && scan.pose->translation != Vec3d{})) return false;
    for (const size_t k : plan.layouts[s].position.index)
      if (scan.fields[k].kind != E57Field::Kind::float32) return false;
  }
  return true;
}

}  // namespace

bool looks_like_e57(const ByteSource& source) { return source.begins_with("ASTM-E57"); }

void read_e57(ByteSource& source, PointSink& sink, ReadReport& report, const ReadOptions& options,
              const Context& context) {
  E57Pages pages(source);
  const E57Head head = read_e57_head(pages, report);
  const E57Plan plan = plan_e57(head, options.attributes, pages, report);
  PointStream stream(sink);
  stream.begin(plan.header, source.path());
  PointEnd end;
  end.coordinate_system = head.coordinate_system;
  FileReport file = describe_e57(head, source.path());

  std::vector<std::string> without_grid, with_more, shifted, unseen;
  for (size_t s = 0; s < head.scans.size(); ++s) {
    const E57Scan& scan = head.scans[s];
    E57Records records(pages, scan, plan.sections[s], plan.layouts[s].used(scan.fields.size()));
    E57ScanReader reader(scan, plan.layouts[s], plan.column_of[s], plan.header, stream.samples());
    reader.read(records, context, file.no_return);
    if (records.more_left()) with_more.push_back(in_quotes(scan.name));
    const std::string why = reader.finish(options.trust_viewpoint);
    if (reader.shifted()) shifted.push_back(in_quotes(scan.name));
    if (reader.unseen()) unseen.push_back(in_quotes(scan.name));
    if (!why.empty()) without_grid.push_back(in_quotes(scan.name) + ": " + why);
    for (Scan& found : std::exchange(stream.samples().scans, {})) {
      found.begin += stream.passed();
      found.end += stream.passed();
      end.scans.push_back(std::move(found));
    }
    stream.pass();  // of scans only whole ones: a pose may be none, which all samples of a scan tell
  }
  warn_of_e57("rows and columns not used as a range grid", without_grid, source.path(), report);
  warn_of_e57("more records than recordCount says, ignored", with_more, source.path(), report);
  warn_of_e57(
      "poses taken for shifts of coordinates, not for scanners' places, as they are of round numbers or the samples "
      "were not seen from there (else: --trust-viewpoint)",
      shifted, source.path(), report);
  warn_of_e57("no pose, and samples that were not seen from the origin: no scanner is taken (else: --trust-viewpoint)",
              unseen, source.path(), report);
  stream.finish(std::move(end), std::move(file), {.float32 = e57_float32(head, plan)}, report);
  stream.close();
}

}  // namespace soapfilm::io
