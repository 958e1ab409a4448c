#include "soapfilm/io/range_image.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <string_view>
#include <vector>

#include "soapfilm/io/cell_grid.h"
#include "soapfilm/io/grid_view.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

constexpr std::string_view row_names[] = {"row", "row_index", "rowindex", "v"};
constexpr std::string_view column_names[] = {"column",   "col", "column_index", "columnindex", "col_index",
                                             "colindex", "u"};

const Column* find_index_column(const PointCloud& cloud, std::span<const std::string_view> names) {
  for (const std::string_view name : names)
    for (const Column& column : cloud.columns)
      if (lower_case(column.name) == name) return &column;
  return nullptr;
}

}  // namespace

RangeGrid full_grid(int columns, int rows, bool by_columns) {
  RangeGrid grid{columns, rows, {}};
  grid.sample.resize(static_cast<size_t>(columns) * static_cast<size_t>(rows));
  if (!by_columns) {
    std::iota(grid.sample.begin(), grid.sample.end(), 0);
    return grid;
  }
  int32_t sample = 0;
  for (int c = 0; c < columns; ++c)
    for (int r = 0; r < rows; ++r)
      grid.sample[static_cast<size_t>(r) * static_cast<size_t>(columns) + static_cast<size_t>(c)] = sample++;
  return grid;
}

bool name_cells(const std::vector<std::string>& names) {
  const auto has_one_of = [&](std::span<const std::string_view> wanted) {
    return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      return std::find(wanted.begin(), wanted.end(), lower_case(name)) != wanted.end();
    });
  };
  return has_one_of(row_names) && has_one_of(column_names);
}

std::string give_named_grid(PointCloud& cloud) {
  const Column* rows = find_index_column(cloud, row_names);
  const Column* columns = find_index_column(cloud, column_names);
  if (cloud.scans.size() != 1 || cloud.scans[0].range_grid || rows == nullptr || columns == nullptr) return {};
  Scan& scan = cloud.scans[0];
  CellGrid grid;
  grid.reserve(cloud.size());
  for (size_t i = 0; i < cloud.size(); ++i)
    grid.add(static_cast<double>(rows->values[i]), static_cast<double>(columns->values[i]), 0);
  std::string why = grid.give_to(scan);
  if (!scan.sensor && !scan.view_direction && cloud.sensors.empty() &&
      is_scanner_place(cloud.positions, scan, {}, false))
    scan.sensor = Vec3d{};
  return why;
}

}  // namespace soapfilm::io
