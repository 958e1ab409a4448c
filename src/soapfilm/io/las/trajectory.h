// The way of a moving scanner: its position at any time, from a text file of lines `time x y z`.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "soapfilm/io.h"
#include "soapfilm/vec.h"

namespace soapfilm::io {

class Trajectory {
 public:
  /// Throws InputError for a file without a row, or with a row that has no finite time and position.
  Trajectory(const std::string& path, ReadReport& report);

  /// Between two rows on the straight line between them; not-a-number before the first row and after the last.
  Vec3d at(double time);

  const std::string& path() const { return path_; }
  double first_time() const { return rows_.front().time; }
  double last_time() const { return rows_.back().time; }

 private:
  struct Row {
    double time = 0;
    Vec3d position;
  };

  std::string path_;
  std::vector<Row> rows_;  // by time
  size_t last_ = 0;        // row at or before the time asked for last: times mostly grow
};

}  // namespace soapfilm::io
