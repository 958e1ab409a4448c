// Makes LAZ files of LAS files: bench_laz_tiles FILE..., each beside it with the extension .laz instead. Only what the
// writer of the tests knows: no extended records.
#include <fmt/core.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/io/laz_files.h"

int main(int count, char** arguments) {
  for (int i = 1; i < count; ++i) {
    const std::filesystem::path las = arguments[i];
    std::ifstream in(las, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    const std::string laz = bytes.starts_with("LASF") ? soapfilm::LazFile(bytes, {}).bytes() : "";
    std::ofstream out(std::filesystem::path(las).replace_extension(".laz"), std::ios::binary);
    out.write(laz.data(), static_cast<std::streamsize>(laz.size()));
    out.close();
    if (laz.empty() || !out) {
      fmt::print(stderr, "{}: no LAS file, or its LAZ file cannot be written\n", las.string());
      return 1;
    }
  }
}
