// What simplify and remesh share: a mesh of a file, and what is proved of the coordinates that are written.
#pragma once

#include <limits>
#include <string>

#include "soapfilm/error.h"
#include "soapfilm/io.h"

namespace soapfilm::cli {

/// Of WriteOptions: floats are written only where they are exact.
inline constexpr double proved_precision = std::numeric_limits<double>::min();

inline WriteOptions proved_options(bool ascii) {
  WriteOptions options;
  options.ascii = ascii;
  options.coordinate_precision = proved_precision;
  return options;
}

/// work(), but a mesh that it refuses is the file's fault.
template <class Work>
auto with_mesh_of(const std::string& file, Work&& work) try {
  return work();
} catch (const ParameterError& error) {
  const std::string text = error.what();
  if (text.starts_with("mesh: ")) throw InputError(file + text.substr(4));
  throw;
}

}  // namespace soapfilm::cli
