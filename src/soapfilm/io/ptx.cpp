#include "soapfilm/io/ptx.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/grid_view.h"
#include "soapfilm/io/point_table.h"
#include "soapfilm/io/text/number_line.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

/// The head of a scan. Points are row vectors: world = x axis[0] + y axis[1] + z axis[2] + scanner.
struct PtxHead {
  size_t columns = 0;
  size_t rows = 0;
  size_t line = 0;  ///< of the file, where it begins
  std::array<Vec3d, 3> axis{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3d scanner;

  uint64_t cells() const { return uint64_t{columns} * rows; }
  Vec3d world(double x, double y, double z) const { return x * axis[0] + y * axis[1] + z * axis[2] + scanner; }
};

/// What the rows of a scan with a return hold, by their number of columns.
constexpr size_t ptx_bare = 3, ptx_intensity = 4, ptx_color = 7;

class PtxReader {
 public:
  PtxReader(ByteSource& source, const Context& context, bool trust_pose)
      : source_(source), context_(context), trust_pose_(trust_pose), cursor_(source) {}

  PointCloud read(ReadReport& report) {
    PointCloud all;
    for (std::string_view line; next_filled_line(cursor_, line);) {
      ++scan_;
      const PtxHead head = read_head(line);
      check_axes(head, report);
      PointCloud scan = read_cells(head);
      if (scan.size() > 0) all.append(std::move(scan));
    }
    warn_of_defaults(report);
    const std::string name = std::filesystem::path(source_.path()).stem().string();
    for (size_t s = 0; s < all.scans.size(); ++s)
      all.scans[s].name = all.scans.size() == 1 ? name : fmt::format("{} {}", name, s + 1);
    FileReport file;
    file.path = source_.path();
    file.format = "PTX";
    file.no_return = no_return_;
    file.properties = {"x", "y", "z"};
    if (!all.columns.empty()) file.properties.emplace_back("intensity");
    if (!all.colors.empty())
      for (const char* color : {"red", "green", "blue"}) file.properties.emplace_back(color);
    finish_points(all, std::move(file), {}, report);
    return all;
  }

 private:
  PtxHead read_head(std::string_view line) {
    PtxHead head;
    head.line = cursor_.line();
    head.columns = parse_size(line, "columns");
    head.rows = parse_size(next_line("rows"), "rows");
    for (const char* what :
         {"the scanner's position", "the scanner's x axis", "the scanner's y axis", "the scanner's z axis"})
      parse_vector(what);  // as the matrix says it, but for a user's coordinate system: the matrix counts
    for (Vec3d& axis : head.axis) axis = parse_vector("a row of the matrix", 0);
    head.scanner = parse_vector("the matrix's last row", 1);
    return head;
  }

  size_t parse_size(std::string_view line, const char* what) const {
    std::string_view rest = line;
    std::string_view field;
    int64_t size = 0;
    if (!next_field(rest, field) || !parse_integer(field, size) || size <= 0 || size > INT32_MAX ||
        next_field(rest, field))
      cursor_.fail(
          fmt::format("scan {}: number of {} = {}, must be an integer from 1 up", scan_, what, in_quotes(line)));
    return static_cast<size_t>(size);
  }

  /// `fourth`: the number that must follow, as in rows of the matrix.
  Vec3d parse_vector(const char* what, std::optional<double> fourth = {}) {
    const size_t numbers = fourth ? 4 : 3;
    const size_t count = parse_number_line(cursor_, next_line(what), values_);
    const Vec3d v{values_[0], values_[1], values_[2]};
    if (count != numbers || !is_finite(v))
      cursor_.fail(fmt::format("scan {}: {}: {} numbers, must be {} finite ones", scan_, what, count, numbers));
    constexpr double rounding = 1e-6;
    if (fourth && !(std::abs(values_[3] - *fourth) <= rounding))
      cursor_.fail(
          fmt::format("scan {}: {} ends with {}, must be {}: the position stands in the last row, not in the "
                      "last column",
                      scan_, what, values_[3], *fourth));
    return v;
  }

  std::string_view next_line(std::string_view what) {
    std::string_view line;
    if (!next_filled_line(cursor_, line))
      cursor_.fail(fmt::format("truncated: scan {}: the file ends where {} must follow", scan_, what));
    return line;
  }

  /// Rays stay straight under any matrix that is not singular, so others than rigid motions are used, but named.
  void check_axes(const PtxHead& head, ReadReport& report) {
    const auto& [a, b, c] = head.axis;
    const double lengths[] = {norm(a), norm(b), norm(c)};
    const double box = lengths[0] * lengths[1] * lengths[2];
    const double volume = dot(a, cross(b, c));
    constexpr double singular = 1e-9, unequal = 1e-3;
    if (!(std::abs(volume) > singular * box))
      cursor_.fail(fmt::format("scan {}: its matrix is singular, must map the scan into space", scan_));
    const auto [least, most] = std::minmax_element(std::begin(lengths), std::end(lengths));
    if (warned_ || (*most - *least <= unequal * *most && volume >= (1 - unequal) * box)) return;
    warned_ = true;  // once per file
    report.warnings.push_back(fmt::format(
        "{}:{}: scan {}: its matrix is not a rotation, a shift and one scale: it {} axes of lengths {:.6g}, {:.6g} and "
        "{:.6g}; it is used as it is",
        source_.path(), head.line, scan_, volume < 0 ? "mirrors, with" : "has", lengths[0], lengths[1], lengths[2]));
  }

  PointCloud read_cells(const PtxHead& head) {
    constexpr size_t least_bytes = sizeof("0 0 0");  // with the end of the line, which the last may lack
    if (head.cells() > (cursor_.remaining() + 1) / least_bytes)
      throw InputError(fmt::format("{}:{}: scan {}: {} x {} cells, but the file is truncated: {} bytes are left",
                                   source_.path(), head.line, scan_, head.columns, head.rows, cursor_.remaining()));
    PointCloud cloud;
    RangeGrid grid{static_cast<int>(head.columns), static_cast<int>(head.rows), {}};
    const bool is_image = head.columns > 1 && head.rows > 1;  // else it is a list of points
    if (is_image) grid.sample.assign(head.cells(), -1);
    colors_ = {};
    has_color_ = false;
    columns_ = 0;
    size_t cell = 0;
    for (size_t column = 0; column < head.columns; ++column)
      for (size_t row = 0; row < head.rows; ++row, ++cell) {
        if (cell % rows_between_checks == 0) context_.check();
        if (!read_cell(head, cell, cloud)) continue;
        if (is_image) grid.sample[row * head.columns + column] = static_cast<int32_t>(cloud.size() - 1);
      }
    if (has_color_) cloud.colors = colors_.bytes(true);
    Scan scan;
    scan.end = cloud.size();
    if (is_image) scan.range_grid = std::move(grid);
    if (trust_pose_ || tells_of_scanner(head, cloud, scan))
      scan.sensor = head.scanner;
    else if (cloud.size() > 0)
      defaults_.push_back(scan_);
    cloud.scans.push_back(std::move(scan));
    return cloud;
  }

  /// Programs that merge scans, or convert other formats, write the identity, or a shift that keeps numbers small: no
  /// scanner stood there.
  static bool tells_of_scanner(const PtxHead& head, const PointCloud& cloud, const Scan& scan) {
    constexpr double far = 30;  // diagonals
    if (head.axis != PtxHead().axis) return true;
    if (head.scanner == Vec3d{}) return is_scanner_place(cloud.positions, scan, head.scanner, true);
    return is_near_samples(cloud.positions, scan, head.scanner, far) &&
           judge_view(cloud.positions, scan, head.scanner) != GridView::not_from;
  }

  void warn_of_defaults(ReadReport& report) const {
    if (defaults_.empty()) return;
    report.warnings.push_back(
        fmt::format("{}: scan {}{}: its matrix does not turn, and its samples were not seen from where it says: no "
                    "scanner is taken "
                    "from it (else: --trust-viewpoint)",
                    source_.path(), defaults_.front(),
                    defaults_.size() == 1 ? "" : fmt::format(" and {} more", defaults_.size() - 1)));
  }

  /// False for a cell without a return. Such rows may have fewer columns than others.
  bool read_cell(const PtxHead& head, size_t cell, PointCloud& cloud) {
    std::string_view line;
    if (!next_filled_line(cursor_, line))
      cursor_.fail(fmt::format("truncated: scan {}: the file ends after {} of {} cells", scan_, cell, head.cells()));
    const size_t count = parse_number_line(cursor_, line, values_);
    if (count != ptx_bare && count != ptx_intensity && count != ptx_color)
      cursor_.fail(
          fmt::format("scan {}: cell {} of {}: {} numbers, must be 3 (x y z), 4 (and intensity) or 7 (and "
                      "color)",
                      scan_, cell, head.cells(), count));
    const auto& [x, y, z, intensity, red, green, blue] = values_;
    if (x == 0 && y == 0 && z == 0) {
      ++no_return_;
      cursor_.release();
      return false;
    }
    if (columns_ == 0) begin_samples(count, head.cells() - cell, line.size(), cloud);
    if (count != columns_)
      cursor_.fail(fmt::format("scan {}: cell {}: {} numbers, must be {} as before", scan_, cell, count, columns_));
    cloud.positions.push_back(head.world(x, y, z));
    if (count >= ptx_intensity) cloud.columns[0].values.push_back(static_cast<float>(intensity));
    if (count == ptx_color) {
      const bool none = red == 0 && green == 0 && blue == 0;
      has_color_ = has_color_ || !none;
      if (none)
        colors_.add(-1, -1, -1);
      else
        colors_.add(red, green, blue);
    }
    cursor_.release();
    return true;
  }

  /// Plans the memory of a scan at its first cell with a return.
  void begin_samples(size_t columns, uint64_t cells, size_t line_bytes, PointCloud& cloud) {
    columns_ = columns;
    PointHeader header;
    header.samples = std::min<uint64_t>(cells, (line_bytes + cursor_.remaining() + 2) / (2 * columns));
    header.colors = columns == ptx_color;
    if (columns >= ptx_intensity) header.columns = {"intensity"};
    cloud = cloud_for(header, source_.path());
    if (header.colors) colors_.reserve(header.samples);
  }

  static constexpr size_t rows_between_checks = 4096;

  ByteSource& source_;
  const Context& context_;
  bool trust_pose_;
  TextCursor cursor_;
  std::array<double, ptx_color> values_{};
  size_t scan_ = 0;         // number of the scan in progress, from 1
  size_t columns_ = 0;      // of its rows with a return; 0 before the first
  ColorNumbers colors_;     // of its samples
  bool has_color_ = false;  // one of them is not (0, 0, 0)
  bool warned_ = false;
  std::vector<size_t> defaults_;  // numbers of scans whose matrix tells of no scanner
  size_t no_return_ = 0;
};

/// Is the line this many numbers?
bool is_line_of(std::string_view line, size_t numbers) {
  size_t count = 0;
  for (std::string_view field; next_field(line, field); ++count) {
    double value = 0;
    int64_t whole = 0;
    if (numbers == 1 ? !parse_integer(field, whole) || whole <= 0 : !parse_number(field, value)) return false;
  }
  return count == numbers;
}

}  // namespace

bool looks_like_ptx(const ByteSource& source) {
  constexpr size_t longest_head = 4096;
  constexpr size_t numbers[] = {1, 1, 3, 3, 3, 3, 4, 4, 4, 4};  // of the head's lines
  std::string_view text = after_byte_order_mark(source.bytes()).substr(0, longest_head);
  for (const size_t count : numbers) {
    const size_t end = text.find('\n');
    if (end == std::string_view::npos || !is_line_of(text.substr(0, end), count)) return false;
    text.remove_prefix(end + 1);
  }
  return true;
}

PointCloud read_ptx(ByteSource& source, ReadReport& report, const ReadOptions& options, const Context& context) {
  return PtxReader(source, context, options.trust_viewpoint).read(report);
}

}  // namespace soapfilm::io
