#ifdef SOAPFILM_PROJ
#include "cli/proj_library.h"

#include <fmt/format.h>

#include "soapfilm/error.h"
#ifdef SOAPFILM_PROJ_SONAME
#include <dlfcn.h>
#endif

namespace soapfilm::cli {

namespace {

#ifdef SOAPFILM_PROJ_SONAME

ProjLibrary load() {
  constexpr const char* name = SOAPFILM_PROJ_SONAME;
  void* const library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
  if (!library)
    throw ParameterError(
        fmt::format("coordinate systems need PROJ: its library {} cannot be loaded, install it (libproj)", name));
  ProjLibrary found;
#define SOAPFILM_PROJ_LOAD(function)                                      \
  if (void* const address = dlsym(library, #function))                    \
    found.function = reinterpret_cast<decltype(found.function)>(address); \
  else                                                                    \
    throw ParameterError(fmt::format("coordinate systems need PROJ: {} has no function {}", name, #function));
  SOAPFILM_PROJ_FUNCTIONS(SOAPFILM_PROJ_LOAD)
#undef SOAPFILM_PROJ_LOAD
  return found;
}

#else

ProjLibrary load() {
  ProjLibrary linked;
#define SOAPFILM_PROJ_TAKE(function) linked.function = &::function;
  SOAPFILM_PROJ_FUNCTIONS(SOAPFILM_PROJ_TAKE)
#undef SOAPFILM_PROJ_TAKE
  return linked;
}

#endif

}  // namespace

const ProjLibrary& proj_library() {
  static const ProjLibrary library = load();
  return library;
}

}  // namespace soapfilm::cli
#endif
