#include "cli/scratch.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <new>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include "soapfilm/core/context_state.h"
#include "soapfilm/io/formats.h"
#include "soapfilm/io/sets/set_members.h"
#include "soapfilm/io/text/text.h"
#include "soapfilm/platform/memory.h"
#include "soapfilm/platform/page_pool.h"
#include "soapfilm/platform/scratch.h"

// The sanitizers have an operator new of their own. There vectors stay in memory.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SOAPFILM_MOVES_VECTORS 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SOAPFILM_MOVES_VECTORS 0
#endif
#endif
#ifndef SOAPFILM_MOVES_VECTORS
#define SOAPFILM_MOVES_VECTORS 1
#endif

namespace soapfilm::cli {

namespace {

/// What operator new takes from files. Smaller vectors stay in memory.
class LargeVectors {
 public:
  static constexpr size_t least_bytes = size_t{4} << 20;
  /// Addresses of larger arrays of a pool are multiples of it, others hardly ever.
  static constexpr size_t alignment = size_t{1} << 21;

  static LargeVectors& all() {
    static auto* const vectors = new LargeVectors;  // never freed: others are freed after main()
    return *vectors;
  }

  void move_to(const std::string& folder) {
    pages_.use_folder(folder);
    on_disk_ = true;
  }
  bool on_disk() const { return on_disk_; }

  void* take(size_t bytes) {
    ZeroedMemory memory = pages_.allocate(bytes);
    void* const address = memory.get();
    const std::lock_guard lock(mutex_);
    taken_.emplace(address, std::move(memory));
    return address;
  }
  /// Whether it was one of these.
  bool give_back(void* address) {
    ZeroedMemory memory;
    const std::lock_guard lock(mutex_);
    const auto found = taken_.find(address);
    if (found == taken_.end()) return false;
    memory = std::move(found->second);
    taken_.erase(found);
    return true;
  }

 private:
  const PagePool pages_ = PagePool::make();
  std::atomic<bool> on_disk_{false};
  std::mutex mutex_;
  std::map<void*, ZeroedMemory> taken_;
};

/// Without it the allocator keeps freed vectors of up to 32 MiB for later ones, which go to files.
void return_freed_memory() {
#if defined(__GLIBC__)
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  mallopt(M_TRIM_THRESHOLD, 1 << 20);
#endif
}

uint64_t file_bytes(const std::filesystem::path& file) {
  std::error_code unknown;
  const uintmax_t bytes = std::filesystem::file_size(file, unknown);
  return unknown ? 0 : bytes;
}

/// How large the cloud of a file may become: 24 to 60 bytes a sample.
uint64_t cloud_bytes(const std::string& file) {
  constexpr uint64_t growth = 5;              // from 12 bytes a sample or more
  constexpr uint64_t compressed_growth = 20;  // LAZ: from 3
  const io::Format* const format = io::format_of_extension(file);
  if (!format || !format->names_files()) {
    const std::string extension = io::lower_case(std::filesystem::path(file).extension().string());
    return file_bytes(file) * (extension == ".laz" ? compressed_growth : growth);
  }
  uint64_t sum = 0;
  try {
    io::ByteSource set(file);
    ReadReport unused;
    for (const std::string& member : io::member_paths(set, format->members(set, unused)))
      if (const io::Format* const one = io::format_of_extension(member); !one || !one->names_files())
        sum += cloud_bytes(member);
  } catch (const std::exception&) {  // reading says it
  }
  return sum;
}

}  // namespace

void use_scratch(const std::string& folder, Context& context) {
  check_scratch_folder(folder);
  return_freed_memory();
  context.set_scratch_folder(folder);
  if (SOAPFILM_MOVES_VECTORS != 0)
    context.state().move_vectors = [](const std::string& to) {
      if (!to.empty()) LargeVectors::all().move_to(to);  // what follows the run, such as its check, is large, too
    };
}

void make_room_for(const std::vector<std::string>& files, const Context& context) {
  if (!context.state().move_vectors) return;
  uint64_t cloud = 0;
  for (const std::string& file : files) cloud += cloud_bytes(file);
  constexpr uint64_t part = 8;  // the run needs some 700 bytes a sample
  const uint64_t room = context.memory_limit().value_or(available_memory_bytes());
  if (cloud > room / part) context.state().move_vectors(context.state().scratch_folder);
}

}  // namespace soapfilm::cli

#if SOAPFILM_MOVES_VECTORS
void* operator new(size_t bytes) {
  using soapfilm::cli::LargeVectors;
  if (bytes >= LargeVectors::least_bytes && LargeVectors::all().on_disk()) return LargeVectors::all().take(bytes);
  for (;;) {
    if (void* const memory = std::malloc(bytes > 0 ? bytes : 1)) return memory;
    const std::new_handler handler = std::get_new_handler();
    if (!handler) throw std::bad_alloc();
    handler();
  }
}

void operator delete(void* memory) noexcept {
  using soapfilm::cli::LargeVectors;
  const bool may_be_large = memory && reinterpret_cast<uintptr_t>(memory) % LargeVectors::alignment == 0;
  if (!may_be_large || !LargeVectors::all().give_back(memory)) std::free(memory);
}
void operator delete(void* memory, size_t) noexcept { operator delete(memory); }
#endif
