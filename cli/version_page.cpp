#include "cli/version_page.h"

#include <fmt/format.h>

#include "cli/build_facts.h"
#include "soapfilm/context.h"
#include "soapfilm/version.h"

namespace soapfilm::cli {

std::string version_page() {
  const std::string platform = portable_platform ? "portable" : "Linux's own";
  return fmt::format(
      "soapfilm {}\n"
      "built by:   {}, {}\n"
      "built for:  {}, system calls: {}\n"
      "SIMD:       {} (this processor's, best first)\n"
      "threads:    {}\n"
      "OpenVDB:    {}\n"
      "libraries:  {}\n"
      "license:    MIT\n",
      version, built_by, built_as, built_for, platform, fmt::join(simd_targets(), " "),
      std_threads ? "std::thread" : "oneTBB", openvdb_output ? "yes, writes .vdb" : "no", built_with);
}

}  // namespace soapfilm::cli
