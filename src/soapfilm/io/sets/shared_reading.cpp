#include "soapfilm/io/sets/shared_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <span>
#include <system_error>
#include <utility>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/hash.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/ranks.h"
#include "soapfilm/error.h"
#include "soapfilm/io/sets/cloud_message.h"
#include "soapfilm/io/sets/error_message.h"

namespace soapfilm::io {

namespace {

/// What one rank has read in a round.
struct OwnFiles {
  explicit OwnFiles(std::vector<size_t> which) : files(std::move(which)), clouds(files.size()), reports(files.size()) {}

  std::vector<size_t> files;  ///< in order
  std::vector<PointCloud> clouds;
  std::vector<ReadReport> reports;
  ErrorMessage error;  ///< of the first file that cannot be read, if there is one
};

void read_own(OwnFiles& own, const Context& context, const ReadOne& read) {
  std::vector<std::exception_ptr> errors(own.files.size());
  try {
    parallel_for(context, own.files.size(), 1, [&](size_t k) {
      try {
        own.clouds[k] = read(own.files[k], own.reports[k]);
      } catch (...) {
        errors[k] = std::current_exception();
        throw;
      }
    });
  } catch (const Cancelled&) {
    throw;
  } catch (...) {
    const auto first = std::find_if(errors.begin(), errors.end(), [](const auto& error) { return error != nullptr; });
    if (first == errors.end()) throw;
    own.error = message_of(*first, own.files[static_cast<size_t>(first - errors.begin())]);
  }
}

/// All but the arrays of samples.
std::vector<std::byte> packed_files(OwnFiles& own) {
  Packer to;
  for (size_t k = 0; k < own.files.size(); ++k) {
    pack(to, own.reports[k]);
    pack(to, own.clouds[k]);
  }
  return std::move(to.bytes);
}

/// Brings each rank the arrays of the cloud that each has; those of others have their sizes.
void bring_arrays(Ranks& ranks, std::vector<PointCloud>& of_rank) {
  std::vector<Ranks::Message> out, in;
  const std::vector<std::span<std::byte>> own = arrays_of(of_rank[static_cast<size_t>(ranks.rank())]);
  for (int r = 0; r < ranks.count(); ++r) {
    if (r == ranks.rank()) continue;
    for (const std::span<std::byte> array : own) out.push_back({r, array.data(), array.size()});
    for (const std::span<std::byte> array : arrays_of(of_rank[static_cast<size_t>(r)]))
      in.push_back({r, array.data(), array.size()});
  }
  ranks.exchange(out, in);
}

/// Files [begin, end), each once.
struct Round {
  size_t begin, end;
  std::span<const int> readers;  ///< of all files

  std::vector<size_t> of(int rank) const {
    std::vector<size_t> files;
    for (size_t i = begin; i < end; ++i)
      if (readers[i] == rank) files.push_back(i);
    return files;
  }
};

/// What `own` and the other ranks have read, in order.
void append_round(const Round& round, OwnFiles& own, Ranks& ranks, PointCloud& all, ReadReport& report) {
  const auto count = static_cast<size_t>(ranks.count());
  throw_first(ranks, own.error);
  const std::vector<std::vector<std::byte>> bytes = bytes_of_all(ranks, packed_files(own));
  std::vector<Unpacker> from(bytes.begin(), bytes.end());
  size_t taken = 0;
  for (size_t begin = round.begin; begin < round.end; begin += count) {
    const std::span<const int> readers = round.readers.subspan(begin, std::min(count, round.end - begin));
    std::vector<PointCloud> clouds(count);
    std::vector<ReadReport> reports(count);
    for (const int reader : readers) {
      const auto r = static_cast<size_t>(reader);
      if (reader == ranks.rank()) {
        clouds[r] = std::move(own.clouds[taken]);
        reports[r] = std::move(own.reports[taken++]);
      } else {
        pack(from[r], reports[r]);
        pack(from[r], clouds[r]);
      }
    }
    bring_arrays(ranks, clouds);
    for (const int reader : readers)
      append_file(std::move(clouds[static_cast<size_t>(reader)]), std::move(reports[static_cast<size_t>(reader)]), all,
                  report);
  }
}

constexpr uint64_t no_file = UINT64_MAX;

/// Of what is read, but for what is in it: samples follow from all of a trajectory.
uint64_t hash_of(const std::vector<std::string>& paths, const ReadOptions& options) {
  const auto& [columns, trajectory, trust_viewpoint, attributes, spacing] = options;
  Hash hash;
  hash.add(paths.size());
  for (const std::string& path : paths) hash.add(path);
  hash.add(columns);
  hash.add(trajectory);
  std::ifstream path(trajectory, std::ios::binary);
  hash.add(std::string(std::istreambuf_iterator<char>(path), {}));
  hash.add(trust_viewpoint);
  for (const std::string& name : attributes) hash.add(name);
  hash.add(spacing);
  return hash.value();
}

void require_same_bytes(Ranks& ranks, const std::vector<std::string>& paths, const std::vector<uint64_t>& file_bytes) {
  const size_t count = paths.size();
  const std::vector<uint64_t> all = of_all(ranks, std::span<const uint64_t>(file_bytes));
  const auto text = [](uint64_t bytes) { return bytes == no_file ? "none" : fmt::format("{} bytes", bytes); };
  for (size_t i = count; i < all.size(); ++i)
    if (const uint64_t first = all[i % count]; all[i] != first)
      throw InputError(fmt::format("{}: of this file rank {} has {}, rank 0 {}: each needs the same files",
                                   paths[i % count], i / count, text(all[i]), text(first)));
}

}  // namespace

std::vector<uint64_t> agreed_file_bytes(const std::vector<std::string>& paths, const ReadOptions& options,
                                        const Context& context) {
  std::vector<uint64_t> file_bytes;
  for (const std::string& path : paths) {
    std::error_code unknown;
    const uintmax_t bytes = std::filesystem::file_size(path, unknown);
    file_bytes.push_back(unknown ? no_file : uint64_t{bytes});
  }
  if (Ranks* const ranks = ranks_of(context)) {
    require_same(*ranks, "input files", hash_of(paths, options));
    require_same_bytes(*ranks, paths, file_bytes);
  }
  std::replace(file_bytes.begin(), file_bytes.end(), no_file, uint64_t{0});
  return file_bytes;
}

std::vector<int> readers_of(const std::vector<uint64_t>& file_bytes, int ranks) {
  const auto count = static_cast<size_t>(ranks);
  std::vector<int> readers(file_bytes.size());
  std::vector<uint64_t> load(count);
  for (size_t begin = 0; begin < readers.size(); begin += count) {
    std::vector<size_t> files(std::min(count, readers.size() - begin));
    std::iota(files.begin(), files.end(), begin);
    std::stable_sort(files.begin(), files.end(), [&](size_t a, size_t b) { return file_bytes[a] > file_bytes[b]; });
    std::vector<int> free(count);
    std::iota(free.begin(), free.end(), 0);
    std::stable_sort(free.begin(), free.end(),
                     [&](int a, int b) { return load[static_cast<size_t>(a)] < load[static_cast<size_t>(b)]; });
    for (size_t k = 0; k < files.size(); ++k) {
      readers[files[k]] = free[k];
      load[static_cast<size_t>(free[k])] += file_bytes[files[k]];
    }
  }
  return readers;
}

PointCloud read_shared(const std::vector<uint64_t>& file_bytes, ReadReport& report, const Context& context,
                       const ReadOne& read) {
  Ranks& ranks = *ranks_of(context);
  const std::vector<int> threads = of_all(ranks, context.threads());
  const auto at_once = static_cast<size_t>(*std::min_element(threads.begin(), threads.end()));
  const std::vector<int> readers = readers_of(file_bytes, ranks.count());
  const size_t count = readers.size(), in_round = at_once * static_cast<size_t>(ranks.count());
  PointCloud all;
  for (size_t first = 0; first < count; first += in_round) {
    const Round round{first, std::min(first + in_round, count), readers};
    OwnFiles own(round.of(ranks.rank()));
    read_own(own, context, read);
    append_round(round, own, ranks, all, report);
    context.progress().advance(static_cast<double>(round.end) / static_cast<double>(count), {});
  }
  return all;
}

}  // namespace soapfilm::io
