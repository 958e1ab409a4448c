#include "soapfilm/io/unnamed_columns.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "soapfilm/core/memory.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io/leading_columns.h"
#include "soapfilm/io/point_columns.h"
#include "soapfilm/io/point_table.h"

namespace soapfilm::io {

namespace {

using Columns = std::vector<Column>;

bool is_whole_number(double value) { return value == std::floor(value); }

/// So many rows may differ from what all others are.
size_t odd_rows_of(size_t rows) { return std::max<size_t>(rows >= 4 ? 1 : 0, rows / 50); }

Vec3f row_of_three(const Columns& columns, size_t first, size_t row) {
  return {columns[first].values[row], columns[first + 1].values[row], columns[first + 2].values[row]};
}

/// Lengths of about 1, or of about one value in many directions; zero is no normal.
bool are_normals(const Columns& columns, size_t first) {
  const size_t rows = columns[first].values.size();
  std::vector<float> lengths;
  Vec3d sum{};
  bool negative = false;
  for (size_t i = 0; i < rows; ++i) {
    const Vec3f n = row_of_three(columns, first, i);
    if (!is_finite(n) || n == Vec3f{}) continue;
    const double length = norm(static_cast<Vec3d>(n));
    lengths.push_back(static_cast<float>(length));
    sum += static_cast<Vec3d>(n) / length;
    negative = negative || n.x < 0 || n.y < 0 || n.z < 0;
  }
  if (lengths.empty() || lengths.size() < rows / 10) return false;
  const auto near = [&](float length, float tolerance) {
    const auto count = std::count_if(lengths.begin(), lengths.end(),
                                     [&](float l) { return std::abs(l - length) <= tolerance * length; });
    return static_cast<size_t>(count) + odd_rows_of(lengths.size()) >= lengths.size();
  };
  if (near(1, 0.05f)) return true;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  constexpr double same_direction = 0.9;  // as those of a position far away are
  return negative && near(*middle, 0.02f) && norm(sum) < same_direction * static_cast<double>(lengths.size());
}

/// The largest number that colors of this kind may hold.
enum class ColorRange { none = 0, one = 1, byte = 255, word = 65535 };

/// What the channels of three columns have in common.
struct ChannelRanges {
  std::array<float, 3> least{}, most{};  // of the rows within the range
  size_t outside = 0;                    // rows beyond it, or negative, or not finite
  size_t fractional = 0;                 // rows of the others whose numbers are not whole
};

ChannelRanges channel_ranges(const Columns& columns, size_t first, ColorRange range) {
  const float limit = static_cast<float>(range);
  ChannelRanges all;
  all.least.fill(limit);
  for (size_t i = 0; i < columns[first].values.size(); ++i) {
    const Vec3f c = row_of_three(columns, first, i);
    if (!(c.x >= 0 && c.y >= 0 && c.z >= 0 && c.x <= limit && c.y <= limit && c.z <= limit)) {
      ++all.outside;
      continue;
    }
    for (size_t k = 0; k < 3; ++k) {
      const float value = c[static_cast<int>(k)];
      all.least[k] = std::min(all.least[k], value);
      all.most[k] = std::max(all.most[k], value);
    }
    all.fractional += !(is_whole_number(c.x) && is_whole_number(c.y) && is_whole_number(c.z));
  }
  return all;
}

/// Colors are numbers of one range in which the channels are alike; a count of returns or a class beside an
/// intensity is not.
ColorRange color_range(const Columns& columns, size_t first) {
  constexpr float most_returns = 15;
  for (const ColorRange range : {ColorRange::one, ColorRange::byte, ColorRange::word}) {
    const ChannelRanges all = channel_ranges(columns, first, range);
    const size_t rows = columns[first].values.size();
    if (all.outside > odd_rows_of(rows) || all.outside == rows) continue;
    if (range == ColorRange::one) {
      if (all.fractional == 0) continue;
      return range;
    }
    const float largest = *std::max_element(all.most.begin(), all.most.end());
    const float smallest = *std::min_element(all.most.begin(), all.most.end());
    if (all.outside + all.fractional > odd_rows_of(rows) || largest <= 1) return ColorRange::none;
    if (range == ColorRange::word) return smallest >= largest / 16 && all.least != all.most ? range : ColorRange::none;
    for (size_t k = 0; k < 3; ++k)
      if (all.least[k] >= 1 && all.most[k] <= most_returns && largest > 4 * most_returns) return ColorRange::none;
    return range;
  }
  return ColorRange::none;
}

/// The largest value of its kind in all rows, as opacity mostly is.
bool is_all_opaque(const Column& column) {
  const float value = column.values.empty() ? 0 : column.values[0];
  return (value == 255 || value == 1 || value == 65535) &&
         std::all_of(column.values.begin(), column.values.end(), [&](float v) { return v == value; });
}

/// Of four columns, is the last another kind of number than the two in the middle, rather than the first? The intensity
/// is first in all programs that write it: only where the sizes of the numbers say so.
bool odd_one_is_last(const Columns& columns, size_t first) {
  std::array<double, 4> largest{};
  for (size_t k = 0; k < 4; ++k)
    for (const float value : columns[first + k].values)
      if (std::isfinite(value)) largest[k] = std::max(largest[k], static_cast<double>(value));
  const double middle = std::log1p(std::max(largest[1], largest[2]));
  const auto differs = [&](double value) { return std::abs(std::log1p(value) - middle); };
  return differs(largest[3]) > differs(largest[0]) + std::log(2.0);
}

/// Where normals and colors begin among the further columns.
struct ColumnLayout {
  std::optional<size_t> normal, color, opacity;
  bool before_odd_one = false;  // r g b i, not i r g b
  ColorRange range = ColorRange::none;
};

ColumnLayout find_layout(const Columns& columns) {
  ColumnLayout layout;
  const size_t count = columns.size();
  for (size_t k = 0; k + 3 <= count;) {
    if (!layout.normal && are_normals(columns, k)) {
      layout.normal = k;
      k += 3;
      continue;
    }
    const ColorRange range = layout.color ? ColorRange::none : color_range(columns, k);
    if (range == ColorRange::none) {
      ++k;
      continue;
    }
    const bool opaque = k + 4 <= count && is_all_opaque(columns[k + 3]);
    // i r g b looks like r g b with a further value.
    const bool unclear = !opaque && k + 4 <= count && color_range(columns, k + 1) != ColorRange::none &&
                         (k + 4 == count || (k + 7 <= count && are_normals(columns, k + 4)));
    layout.before_odd_one = unclear && odd_one_is_last(columns, k);
    const bool after_intensity = unclear && !layout.before_odd_one;
    layout.color = after_intensity ? k + 1 : k;
    layout.range = after_intensity ? color_range(columns, k + 1) : range;
    if (opaque) layout.opacity = k + 3;
    k = *layout.color + (opaque ? 4 : 3);
  }
  return layout;
}

std::vector<Vec3f> normals_of(const Columns& columns, size_t first) {
  std::vector<Vec3f> normals(columns[first].values.size());
  for (size_t i = 0; i < normals.size(); ++i) normals[i] = row_of_three(columns, first, i);
  return normals;
}

std::vector<Rgb8> colors_of(const Columns& columns, size_t first, ColorRange range, UnnamedColumns& unnamed) {
  const float limit = static_cast<float>(range);
  size_t odd = 0;
  ColorNumbers numbers;
  numbers.reserve(columns[first].values.size());
  for (size_t i = 0; i < columns[first].values.size(); ++i) {
    const Vec3f c = row_of_three(columns, first, i);
    const bool is_color = std::min({c.x, c.y, c.z}) >= 0 && std::max({c.x, c.y, c.z}) <= limit;  // else an odd row
    odd += !is_color;
    numbers.add(is_color ? c.x : -1, is_color ? c.y : -1, is_color ? c.z : -1);
  }
  if (odd > 0)
    unnamed.remarks.push_back(
        fmt::format("{} of {} samples have numbers that are no color: gray", odd, columns[first].values.size()));
  return numbers.bytes(false);
}

/// The first columns, of these names, are no coordinates: those are the next three. Returns the columns.
Columns shift_positions(PointCloud& cloud, UnnamedColumns& unnamed, const std::vector<std::string>& leading) {
  const size_t count = leading.size();
  for (size_t i = 0; i < cloud.size(); ++i) {
    Vec3d& p = cloud.positions[i];
    cloud.columns[0].values[i] = static_cast<float>(p.x);
    if (count == 2) cloud.columns[1].values[i] = static_cast<float>(p.y);
    p = count == 1 ? Vec3d{p.y, p.z, unnamed.fourth[i]} : Vec3d{p.z, unnamed.fourth[i], unnamed.fifth[i]};
  }
  Columns front;
  for (size_t k = 0; k < count; ++k) {
    cloud.columns[k].name = leading[k];
    cloud.columns[k].is_label = holds_labels(leading[k]);
    front.push_back(std::move(cloud.columns[k]));
  }
  cloud.columns.erase(cloud.columns.begin(), cloud.columns.begin() + static_cast<std::ptrdiff_t>(count));
  std::vector<std::string> names = leading;
  for (const char* axis : {"x", "y", "z"}) names.emplace_back(axis);
  std::copy(names.begin(), names.end(), unnamed.names.begin());
  return front;
}

/// Puts columns before x y z where they belong, with a remark; returns them.
Columns take_leading(PointCloud& cloud, UnnamedColumns& unnamed) {
  const size_t others = cloud.columns.size();
  if (others >= 3 && are_normals(cloud.columns, 0)) return {};
  if (others == 3 && color_range(cloud.columns, 0) != ColorRange::none) return {};
  const char* const else_plain = unnamed.can_be_named ? " (else: --columns x,y,z,...)" : "";
  switch (judge_leading(cloud, unnamed)) {
    case LeadingColumns::none:
      return {};
    case LeadingColumns::unclear:
      unnamed.remarks.push_back(
          fmt::format("column 1 is whole or rises from row to row, as a point's number or a time; it is taken for x{}",
                      unnamed.can_be_named ? " (else: --columns time,x,y,z,...)" : ""));
      return {};
    case LeadingColumns::unclear_cells:
      unnamed.remarks.push_back(
          fmt::format("columns 1 and 2 go through the cells of a grid; they are taken for x and y{}",
                      unnamed.can_be_named ? " (else: --columns row,column,x,y,z,...)" : ""));
      return {};
    case LeadingColumns::number:
      unnamed.remarks.push_back(fmt::format(
          "column 1 counts the rows: taken for the point's number, columns 2 to 4 for x y z{}", else_plain));
      return shift_positions(cloud, unnamed, {"id"});
    case LeadingColumns::row_column:
    case LeadingColumns::column_row:
      break;
  }
  unnamed.remarks.push_back(fmt::format(
      "columns 1 and 2 count the cells of a grid: taken for rows and columns, columns 3 to 5 for x y z{}", else_plain));
  const bool row_first = judge_leading(cloud, unnamed) == LeadingColumns::row_column;
  return shift_positions(cloud, unnamed, {row_first ? "row" : "column", row_first ? "column" : "row"});
}

/// Such as " with --columns x,y,z,column_4".
std::string option_of(const UnnamedColumns& unnamed) {
  constexpr size_t most = 20;
  const auto end = unnamed.names.begin() + static_cast<std::ptrdiff_t>(std::min(most, unnamed.names.size()));
  return fmt::format(" with --columns {}{}", fmt::join(unnamed.names.begin(), end, ","),
                     unnamed.names.size() > most ? ",..." : "");
}

/// Gives the columns that are left over a name if their place says one, else a remark.
void name_others(Columns& columns, const ColumnLayout& layout, const std::vector<bool>& used, UnnamedColumns& unnamed,
                 size_t first_column) {
  const bool alone = columns.size() == 1;
  const auto others = std::count(used.begin(), used.end(), false);
  constexpr size_t most_named = 12;
  size_t unnamed_count = 0;
  std::string left;
  for (size_t k = 0; k < columns.size(); ++k) {
    if (used[k]) continue;
    const bool beside_color = layout.color && (k + 1 == *layout.color || k == *layout.color + 3);
    const bool before_normal = layout.normal && k + 1 == *layout.normal;
    if (alone || (others == 1 && (beside_color || before_normal)))
      columns[k].name = unnamed.names[first_column + k] = "intensity";
    else if (unnamed_count++ < most_named)
      left += (left.empty() ? "" : ", ") + columns[k].name;
  }
  if (left.empty()) return;
  if (unnamed_count > most_named) left += fmt::format(" and {} more", unnamed_count - most_named);
  unnamed.remarks.push_back(
      fmt::format("nothing says what these columns are, and they are not like normals or colors: kept as attributes "
                  "{}; name{} them{}",
                  left, unnamed.can_be_named ? " or skip ('-')" : " the fields of the array to use",
                  unnamed.can_be_named ? option_of(unnamed) : ""));
}

}  // namespace

void judge_unnamed_columns(PointCloud& cloud, UnnamedColumns& unnamed) {
  if (cloud.columns.empty() || cloud.size() == 0) return;
  Columns front = take_leading(cloud, unnamed);
  release(unnamed.fourth);
  release(unnamed.fifth);

  Columns& columns = cloud.columns;
  const size_t first_column = 3 + front.size();
  const ColumnLayout layout = find_layout(columns);
  std::vector<bool> used(columns.size());
  const auto use = [&](size_t first, std::initializer_list<const char*> names) {
    size_t k = first;
    for (const char* name : names) {
      used[k] = true;
      unnamed.names[first_column + k++] = name;
    }
  };
  if (layout.normal) {
    cloud.normals = normals_of(columns, *layout.normal);
    use(*layout.normal, {"nx", "ny", "nz"});
  }
  if (layout.color) {
    cloud.colors = colors_of(columns, *layout.color, layout.range, unnamed);
    use(*layout.color, {"red", "green", "blue"});
    if (layout.before_odd_one)
      unnamed.remarks.push_back(fmt::format("columns {} to {} are taken for colors, by the sizes of their numbers",
                                            first_column + *layout.color + 1, first_column + *layout.color + 3));
  }
  if (layout.opacity) use(*layout.opacity, {"alpha"});
  name_others(columns, layout, used, unnamed, first_column);
  for (size_t k = 0; k < columns.size(); ++k)
    if (!used[k]) front.push_back(std::move(columns[k]));
  columns = std::move(front);
}

}  // namespace soapfilm::io
