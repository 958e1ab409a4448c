// What columns without names are, judged by their values in all rows.
#pragma once

#include <string>
#include <vector>

#include "soapfilm/cloud.h"

namespace soapfilm::io {

/// A cloud whose positions are the first three columns of a text, with all further ones in cloud.columns.
struct UnnamedTextColumns {
  std::vector<std::string> names;      ///< of the text's columns, in order
  std::vector<double> fourth;          ///< the fourth column, if the first rises from row to row; else empty
  std::vector<std::string> remarks{};  ///< what the user should know
};

/// Makes normals, colors, an intensity, numbers or times of the further columns, as far as their values say that they
/// are. Then `names` say what was found.
void judge_text_columns(PointCloud& cloud, UnnamedTextColumns& unnamed);

}  // namespace soapfilm::io
