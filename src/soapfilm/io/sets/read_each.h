// Several files read at once, as one cloud in their order.
#pragma once

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/io.h"

namespace soapfilm::io {

/// read(i, report) for i in [0, count), as many at once as there are threads, so that no more clouds than that wait to
/// be appended. Cloud, report and error are those of reading one after the other; after an error the report is
/// incomplete. read() is not on the calling thread alone: it must not report progress.
template <class Read>
PointCloud read_each(size_t count, ReadReport& report, const Context& context, Read&& read) {
  const auto at_once = static_cast<size_t>(context.threads());
  PointCloud all;
  for (size_t first = 0; first < count; first += at_once) {
    const size_t files = std::min(at_once, count - first);
    std::vector<PointCloud> clouds(files);
    std::vector<ReadReport> reports(files);
    parallel_for(context, files, 1, [&](size_t i) { clouds[i] = read(first + i, reports[i]); });
    for (size_t i = 0; i < files; ++i) {
      all.append(std::move(clouds[i]));
      std::move(reports[i].files.begin(), reports[i].files.end(), std::back_inserter(report.files));
      std::move(reports[i].warnings.begin(), reports[i].warnings.end(), std::back_inserter(report.warnings));
    }
    context.progress().advance(static_cast<double>(first + files) / static_cast<double>(count), {});
  }
  return all;
}

}  // namespace soapfilm::io
