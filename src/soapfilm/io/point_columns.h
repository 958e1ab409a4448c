// What the columns of a table of samples mean, by their names: for every format whose files name them.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace soapfilm::io {

/// Three columns that belong together; used only if all exist.
struct Triple {
  static constexpr size_t absent = static_cast<size_t>(-1);
  std::array<size_t, 3> index{absent, absent, absent};

  bool present() const { return index[0] != absent && index[1] != absent && index[2] != absent; }
  size_t operator[](size_t k) const { return index[k]; }
};

/// Indices into the list of names.
struct PointColumns {
  Triple position;
  Triple normal;
  Triple sensor;  ///< the scanner's position, per sample
  Triple color;
  Triple splat_color;       ///< of 3D Gaussian splats, if there is no color: see color_of_splat()
  std::string color_parts;  ///< names of an incomplete color's channels, for a warning; mostly empty
  size_t weight = Triple::absent;
  std::vector<size_t> others;  ///< without a meaning here, in order; of transparency nothing is kept
};

/// Names are compared without case, quotes, blanks, '_', '.', '-', leading '/' and '#', and units in brackets. Of equal
/// ones the first counts. (docs/reference/formats.md has the table.)
PointColumns meaning_of(const std::vector<std::string>& names);

/// Leaves, of the further columns and colors, only those that `attributes` names: by column_name(), or "color". All
/// stay if it names one that is not there, such as "all": who looks for it can then say which are. Returns false then.
bool keep_attributes(const std::vector<std::string>& attributes, const std::vector<std::string>& names,
                     PointColumns& columns);

/// "PATH: 'red', 'green' without ...", if the color is not complete; to `warnings`.
void warn_of_color_parts(const PointColumns& columns, const std::string& path, std::vector<std::string>& warnings);

/// Does any of these names say what its column is? (Then a line of them is a header.)
bool is_known_column(std::string_view name);

/// The name of a further column, as it is carried to vertices: without quotes and blanks around it and "scalar_" before
/// it; one word, as PLY needs it.
std::string column_name(std::string_view name);

/// Do the values of a column of this name say what a sample is, so that a mean of them means nothing?
bool holds_labels(std::string_view name);

}  // namespace soapfilm::io
