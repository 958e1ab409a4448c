// What ranks that read together give, compared with what one process gives.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/error.h"
#include "soapfilm/io.h"
#include "support/thread_ranks.h"

namespace soapfilm {

constexpr test::Cuts any_cuts{1};  // slabs do not matter here

/// All of it, bit by bit: some values are not numbers.
struct Reading {
  PointCloud cloud;
  ReadReport report;

  std::string text() const;
};

template <class T>
void add_bytes(const std::vector<T>& values, std::ostream& to) {
  to << values.size() << ':';
  to.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(T)));
  to << '\n';
}

inline void add_place(const std::optional<Vec3d>& place, std::ostream& to) {
  if (place) to << std::hexfloat << place->x << ' ' << place->y << ' ' << place->z;
  to << '\n';
}

inline void add_cloud(const PointCloud& cloud, std::ostream& to) {
  add_bytes(cloud.positions, to);
  add_bytes(cloud.normals, to);
  add_bytes(cloud.sensors, to);
  add_bytes(cloud.weights, to);
  add_bytes(cloud.colors, to);
  for (const Column& column : cloud.columns) {
    to << column.name << ' ' << column.is_label << '\n';
    add_bytes(column.values, to);
  }
  for (const Scan& scan : cloud.scans) {
    to << scan.name << ' ' << scan.begin << ' ' << scan.end << '\n';
    add_place(scan.sensor, to);
    add_place(scan.view_direction, to);
    if (!scan.range_grid) continue;
    to << scan.range_grid->columns << ' ' << scan.range_grid->rows << '\n';
    add_bytes(scan.range_grid->sample, to);
  }
  to << cloud.coordinate_system << ' ' << cloud.is_survey << '\n';
}

inline void add_report(const ReadReport& report, std::ostream& to) {
  for (const FileReport& file : report.files) {
    to << file.path << '|' << file.format << '|' << file.samples << '|' << file.dropped << '|' << file.no_return << '|'
       << file.ignored_normals;
    for (const std::string& name : file.properties) to << '|' << name;
    to << '\n';
  }
  for (const std::string& warning : report.warnings) to << warning << '\n';
}

inline std::string Reading::text() const {
  std::ostringstream text;
  add_cloud(cloud, text);
  add_report(report, text);
  return text.str();
}

/// Expects on every rank what one process gives.
inline void expect_same_on_all(const std::function<Reading(const Context&)>& read) {
  const auto text_of = [&](const Context& context) { return read(context).text(); };
  const std::string alone = text_of(Context(1));
  EXPECT_GT(alone.size(), 500u);
  for (int count = 1; count <= 4; ++count)
    for (int threads = 1; threads <= 2; ++threads)
      for (const std::string& of_rank : test::on_ranks<std::string>(count, threads, any_cuts, text_of))
        EXPECT_TRUE(of_rank == alone) << count << " ranks, " << threads << " threads";
}

inline Reading read_paths(const std::vector<std::string>& paths, const Context& context) {
  Reading found;
  found.cloud = read_points(paths, &found.report, context);
  return found;
}

/// The line of the InputError that each rank throws.
inline std::vector<std::string> lines_of(int ranks, int threads, const std::function<void(const Context&)>& read) {
  return test::on_ranks<std::string>(ranks, threads, any_cuts, [&](const Context& context) -> std::string {
    try {
      read(context);
      return "nothing was thrown";
    } catch (const InputError& error) {
      return error.what();
    }
  });
}

}  // namespace soapfilm
