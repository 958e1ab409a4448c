#include "soapfilm/core/indices.h"

#include <fmt/core.h>

#include "soapfilm/error.h"

namespace soapfilm {

void require_indices(uint64_t count, uint64_t most, const char* what) {
  if (count > most)
    throw ParameterError(fmt::format(
        "{} {}, must be at most {} in one run: take a larger voxel, or a part of the samples", count, what, most));
}

}  // namespace soapfilm
