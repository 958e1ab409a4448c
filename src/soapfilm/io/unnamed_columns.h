// What columns of numbers without names are, judged by their values in all rows: of text and of arrays.
#pragma once

#include <string>
#include <vector>

#include "soapfilm/cloud.h"

namespace soapfilm::io {

/// A cloud whose positions are the first three columns of a table, with all further ones in cloud.columns.
struct UnnamedColumns {
  std::vector<std::string> names;      ///< of the table's columns, in order
  std::vector<double> fourth, fifth;   ///< columns that may be coordinates, if the first is whole; else empty
  bool can_be_named = true;            ///< the user has --columns
  std::vector<std::string> remarks{};  ///< what the user should know
};

/// Makes normals, colors, an intensity of the further columns, as far as their values say that they are; whole numbers
/// that count rows or cells may come before x y z. Then `names` say what was found.
void judge_unnamed_columns(PointCloud& cloud, UnnamedColumns& unnamed);

}  // namespace soapfilm::io
