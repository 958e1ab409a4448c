#include "cli/read_cloud.h"

#include <fmt/format.h>

namespace soapfilm::cli {

void add_read_options(CLI::App& app, ReadOptions& options) {
  const auto input = [&](auto* option) { return option->group("Input"); };
  input(app.add_option("--columns", options.columns,
                       "Of text files: what their columns are, such as x,y,z,-,nx,ny,nz\n(-: passed over; default: by "
                       "the header, or else by the values)"))
      ->option_text("NAMES");
  input(app.add_option("--trajectory", options.trajectory, "Of LAS files: where the scanner was, lines of time x y z"))
      ->option_text("FILE");
  input(app.add_flag("--trust-viewpoint", options.trust_viewpoint,
                     "Of PCD, PTX and E57 files: a place that is the default, or that the samples\n"
                     "were not seen from, is the scanner's, too"));
}

PointCloud read_cloud(const std::vector<std::string>& files, const ReadOptions& options, const Context& context,
                      ReadReport& read) {
  PointCloud cloud = read_points(files, &read, context, options);
  warn_of(read, context.progress());
  if (read.dropped() > 0)
    context.progress().warn(
        fmt::format("{} of {} samples dropped: not finite", read.dropped(), read.dropped() + cloud.size()));
  if (const size_t none = no_returns(read); none > 0)
    context.progress().info(fmt::format("{} rays without a return dropped", none));
  return cloud;
}

std::filesystem::path named_path(const std::string& input) {
  const std::filesystem::path path = std::filesystem::absolute(input).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

void warn_of(const ReadReport& read, Progress& progress) {
  for (const std::string& warning : read.warnings) progress.warn(warning);
}

size_t no_returns(const ReadReport& read) {
  size_t sum = 0;
  for (const FileReport& file : read.files) sum += file.no_return;
  return sum;
}

}  // namespace soapfilm::cli
