#include "soapfilm/io/sets/input_files.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <map>
#include <system_error>
#include <utility>

#include "soapfilm/error.h"
#include "soapfilm/io.h"
#include "soapfilm/io/files.h"
#include "soapfilm/io/formats.h"
#include "soapfilm/io/sets/file_pattern.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

namespace fs = std::filesystem;

bool is_folder(const std::string& path) {
  std::error_code unknown;
  return fs::is_directory(path, unknown);
}

std::string known_endings() {
  return extensions_of([](const Format& format) { return format.reads_points(); });
}

/// What a folder holds, by what its files can be. Text whose extension is of points alone is told from .txt and .csv,
/// which may be anything.
struct Found {
  std::vector<std::string> sets, scans, point_texts, texts;
};

bool is_any_text(const std::string& path) {
  const std::string extension = lower_case(fs::path(path).extension().string());
  return extension == ".txt" || extension == ".csv";
}

Found files_in(const std::string& folder) {
  Found found;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    std::error_code unknown;
    if (!at->is_regular_file(unknown) || at->path().filename().string().starts_with('.')) continue;
    const std::string path = at->path().string();
    const Format* format = format_of_extension(path);
    if (!format || !format->reads_points()) continue;
    const bool is_text = format->takes("columns");
    (format->names_files()          ? found.sets
     : is_text && is_any_text(path) ? found.texts
     : is_text                      ? found.point_texts
                                    : found.scans)
        .push_back(path);
  }
  if (error) throw InputError(fmt::format("{}: cannot be read: {}", folder, error.message()));
  for (std::vector<std::string>* files : {&found.sets, &found.scans, &found.point_texts, &found.texts})
    std::sort(files->begin(), files->end(), comes_before);
  return found;
}

/// Takes the files out that are so, in order.
template <class Is>
std::vector<std::string> taken_out(std::vector<std::string>& files, Is&& is) {
  const auto out =
      std::stable_partition(files.begin(), files.end(), [&](const std::string& file) { return !is(file); });
  std::vector<std::string> taken(std::make_move_iterator(out), std::make_move_iterator(files.end()));
  files.erase(out, files.end());
  return taken;
}

std::vector<std::string> scans_in(const std::string& folder, std::vector<std::string>& warnings) {
  Found found = files_in(folder);
  if (found.sets.size() == 1) return found.sets;
  const std::vector<std::string> own_meshes = taken_out(found.scans, is_own_mesh);
  std::vector<std::string> meshes =
      taken_out(found.scans, [](const std::string& file) { return file_kind(file) == FileKind::mesh; });
  const std::array<std::vector<std::string>*, 4> by_rank{&found.scans, &found.point_texts, &meshes, &found.texts};
  const auto first = std::find_if(by_rank.begin(), by_rank.end(), [](const auto* files) { return !files->empty(); });
  if (first == by_rank.end())
    throw InputError(
        fmt::format("{}: a folder without scans, must hold files that end in {}", folder, known_endings()));

  const auto tell = [&](const std::vector<std::string>& left_out, const char* why) {
    if (left_out.empty() || &left_out == *first) return;
    const std::string others = left_out.size() == 1 ? "" : fmt::format(" and {} more", left_out.size() - 1);
    warnings.push_back(fmt::format("{}{}: left out, {}; named by itself it is read", left_out.front(), others, why));
  };
  tell(own_meshes, "made by an earlier run");
  tell(meshes, "a mesh with faces");
  tell(found.point_texts, "text beside other scans");
  return std::move(**first);
}

/// The files, or else the folders, that a pattern names.
std::vector<std::string> named_by(const std::string& pattern) {
  const std::vector<std::string> paths = paths_of_pattern(pattern);
  std::vector<std::string> files, folders;
  const auto can_be_read = [](const Format* format) { return format && (format->reads_points() || format->read_mesh); };
  for (const std::string& path : paths) {
    if (is_folder(path))
      folders.push_back(path);
    else if (can_be_read(format_of_extension(path)))
      files.push_back(path);
  }
  if (!files.empty()) return files;
  if (!folders.empty()) return folders;
  if (paths.empty()) throw InputError(pattern + ": a pattern that no file matches");
  throw InputError(fmt::format("{}: a pattern of {} file{}, such as {}, must match files that end in {}", pattern,
                               paths.size(), paths.size() == 1 ? "" : "s", paths.front(), known_endings()));
}

/// Leaves of the names of one file, links resolved, the first one. Pipes may be read twice.
void read_once(std::vector<std::string>& files, std::vector<std::string>& warnings) {
  std::map<std::pair<dev_t, ino_t>, std::string> known;
  std::vector<std::string> once;
  std::string first;
  size_t twice = 0;
  for (std::string& file : files) {
    struct stat status {};
    if (::stat(file.c_str(), &status) == 0 && S_ISREG(status.st_mode)) {
      const auto [place, is_new] = known.try_emplace({status.st_dev, status.st_ino}, file);
      if (!is_new) {
        if (twice++ == 0) first = place->second == file ? file : fmt::format("{}: the file {}", file, place->second);
        continue;
      }
    }
    once.push_back(std::move(file));
  }
  files = std::move(once);
  if (twice == 0) return;
  warnings.push_back(fmt::format("{}{} named twice, read once", first,
                                 twice == 1 ? ": is" : fmt::format(", and {} more files: are", twice - 1)));
}

}  // namespace

bool is_own_mesh(const std::string& path) {
  fs::path name = fs::path(path).stem();
  if (name.extension().string().starts_with(".part_")) name = name.stem();
  const std::string kind = name.extension().string();
  std::error_code error;
  return (kind == ".mesh" || kind == ".preview") && lower_case(fs::path(path).extension().string()) == ".ply" &&
         fs::is_regular_file(path, error) && file_kind(path) == FileKind::mesh;
}

bool is_folder_or_pattern(const std::string& path) { return is_folder(path) || is_pattern(path); }

std::vector<std::string> without_patterns(const std::vector<std::string>& given) {
  std::vector<std::string> paths;
  for (const std::string& path : given) {
    std::error_code unknown;
    if (path.ends_with('/') && !is_pattern(path) && !fs::exists(path, unknown))
      throw InputError(path + ": no such folder");
    if (!is_pattern(path))
      paths.push_back(path);
    else
      for (std::string& named : named_by(path)) paths.push_back(std::move(named));
  }
  return paths;
}

std::vector<std::string> input_files(const std::vector<std::string>& given, std::vector<std::string>& warnings) {
  std::vector<std::string> files;
  for (const std::string& path : without_patterns(given)) {
    if (!is_folder(path))
      files.push_back(path);
    else
      for (std::string& scan : scans_in(path, warnings)) files.push_back(std::move(scan));
  }
  read_once(files, warnings);
  const std::vector<std::string> own_meshes = taken_out(files, is_own_mesh);
  if (files.empty()) return own_meshes;
  constexpr size_t many = 4;  // such as parts
  for (size_t i = 0; i < own_meshes.size() && (i == 0 || own_meshes.size() < many); ++i)
    warnings.push_back(fmt::format("{}{}: left out, a mesh made by an earlier run; alone it is read", own_meshes[i],
                                   own_meshes.size() < many ? "" : fmt::format(" and {} more", own_meshes.size() - 1)));
  return files;
}

}  // namespace soapfilm::io
