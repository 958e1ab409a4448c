// Reads the input as a file. What a reader accepts hangs together; a refusal is one line. The format is that of the
// extension in the environment variable SOAPFILM_FUZZ_FORMAT, such as .las; files that the input names are looked for
// in SOAPFILM_FUZZ_FOLDER. With the argument --formats: prints the extensions of all formats that can be read; with
// --readers: one of each reader.
#include <cstring>
#include <filesystem>

#include "fuzz/fuzzer.h"
#include "fuzz/paged_file.h"
#include "soapfilm/error.h"
#include "soapfilm/io/formats.h"
#include "support/laws_of_files.h"

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t longest);

namespace {

using namespace soapfilm;

std::string path;

std::string environment(const char* name, const char* otherwise) {
  const char* value = std::getenv(name);
  return value ? value : otherwise;
}

/// read(source), which may refuse.
template <class Read>
void read_or_refuse(std::string_view bytes, Read&& read) {
  try {
    io::ByteSource source(path, bytes);
    read(source);
  } catch (const InputError& error) {
    fuzz::require_one_line(error.what());
  } catch (const MemoryError& error) {
    fuzz::require_one_line(error.what());
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  const bool all = *argc == 2 && std::strcmp((*argv)[1], "--formats") == 0;
  if (all || (*argc == 2 && std::strcmp((*argv)[1], "--readers") == 0)) {
    for (const std::string& extension : all ? io::read_extensions() : io::readers())
      std::printf("%s\n", extension.c_str());
    std::fflush(stdout);
    std::_Exit(0);
  }
  const std::string folder = environment("SOAPFILM_FUZZ_FOLDER", ".");
  path = (std::filesystem::path(folder) / "fuzzed").string() + environment("SOAPFILM_FUZZ_FORMAT", ".ply");
  if (!io::format_of_extension(path)) {
    std::fprintf(stderr, "SOAPFILM_FUZZ_FORMAT: %s is read by no format\n", path.c_str());
    std::_Exit(2);
  }
  return 0;
}

/// A change of one byte would make a page's checksum wrong, and nothing behind it would ever be reached.
extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t longest, unsigned int seed) {
  const size_t changed = LLVMFuzzerMutate(data, size, longest);
  if (seed % 16 != 0) fuzz::mend_page_checksums(data, changed);
  return changed;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const Context context(1);
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  read_or_refuse(bytes, [](io::ByteSource& source) {
    const io::Format* format = io::format_of(source);
    if (format && format->has_faces) format->has_faces(source);
  });
  read_or_refuse(bytes, [](io::ByteSource& source) {
    ReadReport report;
    const PointCloud cloud = read_points(source, report, {}, context);
    const std::string broken = test::broken_law(cloud);
    fuzz::require(broken.empty(), broken);
    io::CloudSink blocks(7);
    ReadReport again;
    stream_points(source, blocks, again, {}, context);
    const PointCloud& other = blocks.cloud();
    fuzz::require(other.positions == cloud.positions && other.colors == cloud.colors &&
                      other.normals == cloud.normals && other.columns.size() == cloud.columns.size() &&
                      other.scans.size() == cloud.scans.size() && again.warnings == report.warnings,
                  "blocks of samples are not the cloud");
    for (const std::string& warning : report.warnings) fuzz::require_one_line(warning);
  });
  read_or_refuse(bytes, [](io::ByteSource& source) {
    ReadReport report;
    const std::string broken = test::broken_law(read_mesh(source, report));
    fuzz::require(broken.empty(), broken);
    for (const std::string& warning : report.warnings) fuzz::require_one_line(warning);
  });
  return 0;
}
