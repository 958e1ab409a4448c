#include "soapfilm/io/sets/read_each.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/io/sets/shared_reading.h"

namespace soapfilm::io {

PointCloud read_each(const std::vector<uint64_t>& file_bytes, ReadReport& report, const Context& context,
                     const ReadOne& read) {
  const size_t count = file_bytes.size();
  if (ranks_of(context) && count > 1) return read_shared(file_bytes, report, context, read);
  const auto at_once = static_cast<size_t>(context.threads());
  PointCloud all;
  for (size_t first = 0; first < count; first += at_once) {
    const size_t files = std::min(at_once, count - first);
    std::vector<PointCloud> clouds(files);
    std::vector<ReadReport> reports(files);
    parallel_for(context, files, 1, [&](size_t i) { clouds[i] = read(first + i, reports[i]); });
    for (size_t i = 0; i < files; ++i) append_file(std::move(clouds[i]), std::move(reports[i]), all, report);
    context.progress().advance(static_cast<double>(first + files) / static_cast<double>(count), {});
  }
  return all;
}

void append_file(PointCloud&& cloud, ReadReport&& found, PointCloud& all, ReadReport& report) {
  all.append(std::move(cloud));
  std::move(found.files.begin(), found.files.end(), std::back_inserter(report.files));
  std::move(found.warnings.begin(), found.warnings.end(), std::back_inserter(report.warnings));
}

}  // namespace soapfilm::io
