#include "soapfilm/io/levels.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "soapfilm/io/formats.h"
#include "soapfilm/io/meshes/gltf.h"

namespace soapfilm {

namespace {

bool holds_all_levels(const std::string& path) {
  const io::Format* format = io::format_of_extension(path);
  return format && format->write_mesh == io::write_glb;
}

}  // namespace

std::vector<std::string> level_files(const std::string& path, size_t count) {
  std::vector<std::string> files{path};
  const std::filesystem::path name(path);
  for (size_t level = 1; level < count && !holds_all_levels(path); ++level) {
    std::filesystem::path file = name;
    file.replace_extension(fmt::format("{}{}", level, name.extension().string()));
    files.push_back(file.string());
  }
  return files;
}

WriteReport write_levels(const std::string& path, const std::vector<DetailLevel>& levels, const WriteOptions& options,
                         const Context& context) {
  if (levels.size() > 1 && holds_all_levels(path)) return io::write_glb_levels(path, levels, options);
  const std::vector<std::string> files = level_files(path, levels.size());
  WriteReport all;
  for (size_t level = levels.size(); level-- > 0;) try {
      const WriteReport report = write_mesh(files[level], levels[level].mesh, options, context);
      all.format = report.format;
      all.double_coordinates |= report.double_coordinates;
      all.warnings.insert(all.warnings.begin(), report.warnings.begin(), report.warnings.end());
    } catch (...) {
      std::error_code ignored;
      for (size_t written = level + 1; written < files.size(); ++written)
        std::filesystem::remove(files[written], ignored);
      throw;
    }
  return all;
}

}  // namespace soapfilm
