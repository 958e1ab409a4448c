// PROJ's functions, from its library once they are needed: it brings some forty others along, which would cost every
// command 9 MB and 20 ms.
#pragma once

#include <proj.h>

#define SOAPFILM_PROJ_FUNCTIONS(X)    \
  X(proj_context_create)              \
  X(proj_context_destroy)             \
  X(proj_log_level)                   \
  X(proj_create)                      \
  X(proj_destroy)                     \
  X(proj_is_crs)                      \
  X(proj_get_type)                    \
  X(proj_get_source_crs)              \
  X(proj_crs_get_sub_crs)             \
  X(proj_crs_get_coordinate_system)   \
  X(proj_cs_get_axis_info)            \
  X(proj_create_crs_to_crs_from_pj)   \
  X(proj_normalize_for_visualization) \
  X(proj_trans)

namespace soapfilm::cli {

struct ProjLibrary {
#define SOAPFILM_PROJ_MEMBER(name) decltype(&::name) name = nullptr;
  SOAPFILM_PROJ_FUNCTIONS(SOAPFILM_PROJ_MEMBER)
#undef SOAPFILM_PROJ_MEMBER
};

/// Loaded by the first call. Throws ParameterError where it is not installed.
const ProjLibrary& proj_library();

}  // namespace soapfilm::cli
