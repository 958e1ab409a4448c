#include "soapfilm/io/sets/cloud_message.h"

namespace soapfilm::io {

namespace {

// Members are named all: one more does not compile until it is sent, too.

template <class Way>
void pack_scan(Way& way, Scan& scan) {
  auto& [name, begin, end, sensor, view_direction, range_grid] = scan;
  pack(way, name);
  pack(way, begin);
  pack(way, end);
  pack(way, sensor);
  pack(way, view_direction);
  bool has_grid = range_grid.has_value();
  pack(way, has_grid);
  if (!has_grid) return;
  if (!range_grid) range_grid.emplace();
  auto& [columns, rows, sample] = *range_grid;
  pack(way, columns);
  pack(way, rows);
  pack_size(way, sample);
}

template <class Way>
void pack_cloud(Way& way, PointCloud& cloud) {
  auto& [positions, normals, sensors, weights, colors, columns, scans, coordinate_system, is_survey] = cloud;
  pack_size(way, positions);
  pack_size(way, normals);
  pack_size(way, sensors);
  pack_size(way, weights);
  pack_size(way, colors);
  pack_size(way, columns);
  for (Column& column : columns) {
    auto& [name, values, is_label] = column;
    pack(way, name);
    pack_size(way, values);
    pack(way, is_label);
  }
  pack_size(way, scans);
  for (Scan& scan : scans) pack_scan(way, scan);
  pack(way, coordinate_system);
  pack(way, is_survey);
}

template <class Way>
void pack_report(Way& way, ReadReport& report) {
  auto& [files, warnings] = report;
  pack_size(way, files);
  for (FileReport& file : files) {
    auto& [path, format, samples, dropped, no_return, ignored_normals, properties] = file;
    pack(way, path);
    pack(way, format);
    pack(way, samples);
    pack(way, dropped);
    pack(way, no_return);
    pack(way, ignored_normals);
    pack(way, properties);
  }
  pack(way, warnings);
}

template <class T>
void add_array(std::vector<T>& values, std::vector<std::span<std::byte>>& arrays) {
  static_assert(std::is_trivially_copyable_v<T>);
  if (!values.empty()) arrays.push_back(std::as_writable_bytes(std::span(values)));
}

}  // namespace

void pack(Packer& way, PointCloud& cloud) { pack_cloud(way, cloud); }
void pack(Unpacker& way, PointCloud& cloud) { pack_cloud(way, cloud); }
void pack(Packer& way, ReadReport& report) { pack_report(way, report); }
void pack(Unpacker& way, ReadReport& report) { pack_report(way, report); }

std::vector<std::span<std::byte>> arrays_of(PointCloud& cloud) {
  std::vector<std::span<std::byte>> arrays;
  add_array(cloud.positions, arrays);
  add_array(cloud.normals, arrays);
  add_array(cloud.sensors, arrays);
  add_array(cloud.weights, arrays);
  add_array(cloud.colors, arrays);
  for (Column& column : cloud.columns) add_array(column.values, arrays);
  for (Scan& scan : cloud.scans)
    if (scan.range_grid) add_array(scan.range_grid->sample, arrays);
  return arrays;
}

}  // namespace soapfilm::io
