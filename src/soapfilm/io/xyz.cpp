#include "soapfilm/io/xyz.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "soapfilm/core/memory.h"
#include "soapfilm/error.h"
#include "soapfilm/io/point_table.h"
#include "soapfilm/io/text.h"

namespace soapfilm::io {

namespace {

constexpr size_t most_columns = 9;

/// The meaning of a number of columns; offsets of the first of three, 0 for none.
struct XyzLayout {
  size_t columns;
  size_t normal;
  size_t color;
  const char* names;  // separated by blanks
};
constexpr std::array<XyzLayout, 5> layouts{{{3, 0, 0, "x y z"},
                                            {4, 0, 0, "x y z intensity"},
                                            {6, 3, 0, "x y z nx ny nz"},
                                            {7, 0, 4, "x y z intensity red green blue"},
                                            {9, 3, 6, "x y z nx ny nz red green blue"}}};

bool is_separator(char c) { return is_blank(c) || c == ',' || c == ';'; }

class XyzReader {
 public:
  explicit XyzReader(ByteSource& source) : source_(source), cursor_(source) {}

  PointCloud read(ReadReport& report) {
    std::string_view line;
    while (cursor_.next_line(line)) {
      const size_t columns = split(line);
      if (columns == 1)
        begin_scan();
      else if (columns > 0)
        add_sample(columns);
      cursor_.release();
    }
    if (cloud_.scans.empty()) cloud_.scans.emplace_back();
    close_scan();
    if (cloud_.positions.empty()) throw InputError(source_.path() + ": holds no samples");
    FileReport file;
    file.path = source_.path();
    file.format = "text";
    reinterpret_colors();
    std::string_view names = six_are_colors_ ? "x y z red green blue" : layout_->names;
    for (std::string_view name; next_field(names, name);) file.properties.emplace_back(name);
    finish_points(cloud_, std::move(file), {}, report);
    return std::move(cloud_);
  }

 private:
  /// Parses the numbers of a line, up to a comment, into values_; returns how many.
  size_t split(std::string_view line) {
    size_t columns = 0;
    const char* at = line.data();
    const char* end = at + line.size();
    for (;;) {
      while (at != end && is_separator(*at)) ++at;
      if (at == end || *at == '#' || (*at == '/' && end - at > 1 && at[1] == '/')) return columns;
      const char* begin = at;
      while (at != end && !is_separator(*at)) ++at;
      const std::string_view token(begin, static_cast<size_t>(at - begin));
      if (columns == most_columns) cursor_.fail(fmt::format("more than {} columns", most_columns));
      if (!parse_number(token, values_[columns++]))
        cursor_.fail(fmt::format("column {} = {}, must be a number", columns, in_quotes(token)));
    }
  }

  void add_sample(size_t columns) {
    if (layout_ == nullptr) choose_layout(columns);
    if (columns != layout_->columns)
      cursor_.fail(fmt::format("{} columns, must be {} as before", columns, layout_->columns));
    cloud_.positions.push_back({values_[0], values_[1], values_[2]});
    if (layout_->normal > 0) {
      const double* n = values_.data() + layout_->normal;
      cloud_.normals.push_back({static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])});
    }
    if (layout_->color > 0) cloud_.colors.push_back(color(values_.data() + layout_->color));
  }

  void choose_layout(size_t columns) {
    for (const XyzLayout& layout : layouts)
      if (layout.columns == columns) layout_ = &layout;
    if (layout_ == nullptr)
      cursor_.fail(
          fmt::format("{} columns, must be 3 (x y z), 4 (and intensity), 6 (and a normal), 7 (intensity and "
                      "color) or 9 (normal and color)",
                      columns));
  }

  Rgb8 color(const double* c) const {
    Rgb8 rgb{};
    for (size_t i = 0; i < 3; ++i) {
      if (!(c[i] >= 0 && c[i] <= 255) || c[i] != std::floor(c[i]))
        cursor_.fail(fmt::format("color {}, must be an integer from 0 to 255", c[i]));
      rgb[i] = static_cast<uint8_t>(c[i]);
    }
    return rgb;
  }

  void begin_scan() {
    if (values_[0] < 0 || values_[0] != std::floor(values_[0]))
      cursor_.fail(fmt::format("{} alone on a line, must be a count of samples or at least 3 columns", values_[0]));
    if (!cloud_.scans.empty())
      close_scan();
    else if (!cloud_.positions.empty())
      cursor_.fail("a count of samples after samples without one, must come first");
    promised_ = values_[0];
    cloud_.scans.emplace_back();
    cloud_.scans.back().begin = cloud_.size();
  }

  void close_scan() {
    Scan& scan = cloud_.scans.back();
    scan.end = cloud_.size();
    scan.name = std::filesystem::path(source_.path()).stem().string();
    if (promised_ >= 0 && static_cast<double>(scan.size()) != promised_)
      cursor_.fail(fmt::format("{} samples, must be {} as the count before them says", scan.size(), promised_));
    if (scan.size() == 0) cloud_.scans.pop_back();
  }

  /// Six columns are a position and a normal. But if all are whole numbers up to 255, some above 1, they are colors.
  void reinterpret_colors() {
    if (layout_->columns != 6) return;
    float largest = 0;
    for (const Vec3f& n : cloud_.normals)
      for (int axis = 0; axis < 3; ++axis) {
        if (!(n[axis] >= 0 && n[axis] <= 255) || n[axis] != std::floor(n[axis])) return;
        largest = std::max(largest, n[axis]);
      }
    if (largest <= 1) return;
    six_are_colors_ = true;
    for (const Vec3f& n : cloud_.normals)
      cloud_.colors.push_back({static_cast<uint8_t>(n.x), static_cast<uint8_t>(n.y), static_cast<uint8_t>(n.z)});
    release(cloud_.normals);
  }

  ByteSource& source_;
  TextCursor cursor_;
  PointCloud cloud_;
  const XyzLayout* layout_ = nullptr;
  std::array<double, most_columns> values_{};
  double promised_ = -1;  // number of samples of the scan in progress; < 0 without a count line
  bool six_are_colors_ = false;
};

}  // namespace

PointCloud read_xyz(ByteSource& source, ReadReport& report, const ReadOptions&, const Context&) {
  return XyzReader(source).read(report);
}

}  // namespace soapfilm::io
