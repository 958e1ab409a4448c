#include "soapfilm/io/text/text_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "soapfilm/core/memory.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io/point_columns.h"
#include "soapfilm/io/point_table.h"

namespace soapfilm::io {

namespace {

using TextColumns = std::vector<Column>;

bool is_whole_number(double value) { return value == std::floor(value); }

/// So many rows may differ from what all others are.
size_t odd_rows_of(size_t rows) { return std::max<size_t>(rows >= 4 ? 1 : 0, rows / 50); }

Vec3f row_of_three(const TextColumns& columns, size_t first, size_t row) {
  return {columns[first].values[row], columns[first + 1].values[row], columns[first + 2].values[row]};
}

/// Lengths of about 1, or of about one value in many directions; zero is no normal.
bool are_normals(const TextColumns& columns, size_t first) {
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

ChannelRanges channel_ranges(const TextColumns& columns, size_t first, ColorRange range) {
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
ColorRange color_range(const TextColumns& columns, size_t first) {
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

/// Where normals and colors begin among the further columns.
struct TextLayout {
  std::optional<size_t> normal, color, opacity;
  ColorRange range = ColorRange::none;
};

TextLayout find_text_layout(const TextColumns& columns) {
  TextLayout layout;
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
    // i r g b looks like r g b with a further value: the intensity is first in all programs that write it.
    const bool after_intensity = !opaque && k + 4 <= count && color_range(columns, k + 1) != ColorRange::none &&
                                 (k + 4 == count || (k + 7 <= count && are_normals(columns, k + 4)));
    layout.color = after_intensity ? k + 1 : k;
    layout.range = after_intensity ? color_range(columns, k + 1) : range;
    if (opaque) layout.opacity = k + 3;
    k = *layout.color + (opaque ? 4 : 3);
  }
  return layout;
}

std::vector<Vec3f> normals_of(const TextColumns& columns, size_t first) {
  std::vector<Vec3f> normals(columns[first].values.size());
  for (size_t i = 0; i < normals.size(); ++i) normals[i] = row_of_three(columns, first, i);
  return normals;
}

std::vector<Rgb8> colors_of(const TextColumns& columns, size_t first, ColorRange range) {
  const float limit = static_cast<float>(range);
  ColorNumbers numbers;
  numbers.reserve(columns[first].values.size());
  for (size_t i = 0; i < columns[first].values.size(); ++i) {
    const Vec3f c = row_of_three(columns, first, i);
    const bool is_color = c.x <= limit && c.y <= limit && c.z <= limit;  // else an odd row
    numbers.add(is_color ? c.x : -1, is_color ? c.y : -1, is_color ? c.z : -1);
  }
  return numbers.bytes(false);
}

/// What the first column is where it rises in all rows.
enum class LeadingColumn { position, number, time, unknown };

/// Counted from row to row; some numbers may be missing.
bool counts_up(const std::vector<Vec3d>& positions) {
  size_t ones = 0;
  for (size_t i = 0; i < positions.size(); ++i) {
    if (!is_whole_number(positions[i].x)) return false;
    ones += i > 0 && positions[i].x - positions[i - 1].x == 1;
  }
  const size_t steps = positions.size() - 1;
  return steps >= 3 && (ones == steps || (steps >= 9 && 2 * ones >= steps));
}

/// Do the values go from row to row in steps that are small beside their range, as a scanner's do?
template <class Value>
bool goes_in_small_steps(size_t rows, Value&& value) {
  constexpr double small = 0.1;  // 1/3 for values in any order
  double least = value(0), most = value(0), way = 0;
  for (size_t i = 1; i < rows; ++i) {
    least = std::min(least, value(i));
    most = std::max(most, value(i));
    way += std::abs(value(i) - value(i - 1));
  }
  return most > least && way < small * (most - least) * static_cast<double>(rows - 1);
}

bool may_be_intensity(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return is_whole_number(v); }) ||
         std::all_of(values.begin(), values.end(), [](double v) { return v >= 0 && v <= 1; });
}

LeadingColumn judge_leading(const PointCloud& cloud, const std::vector<double>& fourth) {
  constexpr size_t few = 20;
  const size_t rows = cloud.size();
  if (fourth.size() != rows || rows < 4) return LeadingColumn::position;
  const size_t others = cloud.columns.size();
  if (others >= 3 && are_normals(cloud.columns, 0)) return LeadingColumn::position;
  if (others == 3 && color_range(cloud.columns, 0) != ColorRange::none) return LeadingColumn::position;
  if (counts_up(cloud.positions)) return LeadingColumn::number;
  if (rows < few) return LeadingColumn::position;
  if (goes_in_small_steps(rows, [&](size_t i) { return cloud.positions[i].y; }) &&
      goes_in_small_steps(rows, [&](size_t i) { return cloud.positions[i].z; }) &&
      goes_in_small_steps(rows, [&](size_t i) { return fourth[i]; }))
    return LeadingColumn::time;
  return may_be_intensity(fourth) ? LeadingColumn::position : LeadingColumn::unknown;
}

/// The first column is no coordinate: those are the next three.
void shift_positions(PointCloud& cloud, UnnamedTextColumns& unnamed, const std::string& name) {
  Column& leading = cloud.columns[0];
  leading.name = name;
  leading.is_label = holds_labels(name);
  for (size_t i = 0; i < cloud.size(); ++i) {
    Vec3d& p = cloud.positions[i];
    leading.values[i] = static_cast<float>(p.x);
    p = {p.y, p.z, unnamed.fourth[i]};
  }
  const std::array<std::string, 4> names{name, "x", "y", "z"};
  std::copy(names.begin(), names.end(), unnamed.names.begin());
}

/// Gives the columns that are left over a name if their place says one, else a remark.
void name_others(TextColumns& columns, const TextLayout& layout, const std::vector<bool>& used,
                 UnnamedTextColumns& unnamed, size_t first_column) {
  const bool alone = columns.size() == 1;
  const auto others = std::count(used.begin(), used.end(), false);
  std::string left;
  for (size_t k = 0; k < columns.size(); ++k) {
    if (used[k]) continue;
    const bool beside_color = layout.color && others == 1 && (k + 1 == *layout.color || k == *layout.color + 3);
    if (alone || beside_color)
      columns[k].name = unnamed.names[first_column + k] = "intensity";
    else
      left += (left.empty() ? "" : ", ") + columns[k].name;
  }
  if (left.empty()) return;
  std::string columns_option;
  for (const std::string& name : unnamed.names) columns_option += (columns_option.empty() ? "" : ",") + name;
  unnamed.remarks.push_back(
      fmt::format("nothing says what these columns are, and they are not like normals or colors: "
                  "kept as attributes {}; name or skip ('-') them with --columns {}",
                  left, columns_option));
}

}  // namespace

void judge_text_columns(PointCloud& cloud, UnnamedTextColumns& unnamed) {
  if (cloud.columns.empty() || cloud.size() == 0) return;
  const LeadingColumn leading = judge_leading(cloud, unnamed.fourth);
  TextColumns front;
  if (leading == LeadingColumn::number || leading == LeadingColumn::time) {
    shift_positions(cloud, unnamed, leading == LeadingColumn::number ? "id" : "time");
    front.push_back(std::move(cloud.columns[0]));
    cloud.columns.erase(cloud.columns.begin());
    unnamed.remarks.push_back(
        fmt::format("column 1 {}: taken for the {}, columns 2 to 4 for x y z (else: --columns "
                    "x,y,z,...)",
                    leading == LeadingColumn::number ? "counts the rows" : "rises from row to row",
                    leading == LeadingColumn::number ? "point's number" : "time"));
  } else if (leading == LeadingColumn::unknown) {
    unnamed.remarks.push_back(
        "column 1 rises from row to row, as a time does; it is taken for x (else: --columns time,x,y,z)");
  }
  release(unnamed.fourth);

  TextColumns& columns = cloud.columns;
  const size_t first_column = 3 + front.size();
  const TextLayout layout = find_text_layout(columns);
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
    cloud.colors = colors_of(columns, *layout.color, layout.range);
    use(*layout.color, {"red", "green", "blue"});
  }
  if (layout.opacity) use(*layout.opacity, {"alpha"});
  name_others(columns, layout, used, unnamed, first_column);
  for (size_t k = 0; k < columns.size(); ++k)
    if (!used[k]) front.push_back(std::move(columns[k]));
  columns = std::move(front);
}

}  // namespace soapfilm::io
