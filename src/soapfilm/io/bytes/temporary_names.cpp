#include "soapfilm/io/bytes/temporary_names.h"

#include <unistd.h>

#include <atomic>
#include <climits>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "soapfilm/io/files.h"

namespace soapfilm::io {

/// Where a signal handler can read it: fixed memory that stays, lock-free states.
struct TemporaryName {
  enum State { unused, changing, in_use };
  std::atomic<int> state{unused};
  char path[PATH_MAX] = {};
  TemporaryName* next = nullptr;
};

namespace {

static_assert(std::atomic<int>::is_always_lock_free && std::atomic<TemporaryName*>::is_always_lock_free);
/// All that there ever were, the last one first. The only state at file scope in this folder; a signal handler has no
/// other access.
std::atomic<TemporaryName*> temporary_names{nullptr};

}  // namespace

TemporaryName* remember_temporary(const std::string& path) {
  if (path.size() >= PATH_MAX) return nullptr;
  TemporaryName* name = temporary_names.load();
  for (; name; name = name->next) {
    int expected = TemporaryName::unused;
    if (name->state.compare_exchange_strong(expected, TemporaryName::changing)) break;
  }
  if (!name) {
    name = new TemporaryName;
    name->state = TemporaryName::changing;
    name->next = temporary_names.load();
    while (!temporary_names.compare_exchange_weak(name->next, name)) continue;
  }
  std::memcpy(name->path, path.c_str(), path.size() + 1);
  name->state.store(TemporaryName::in_use);
  return name;
}

void forget_temporary(TemporaryName* name) noexcept {
  if (name) name->state.store(TemporaryName::unused);
}

std::string resolve_links(const std::string& path) {
  std::error_code error;
  const std::filesystem::path resolved = std::filesystem::canonical(path, error);
  return error ? path : resolved.string();
}

}  // namespace soapfilm::io

namespace soapfilm {

void remove_temporary_files() noexcept {
  for (io::TemporaryName* name = io::temporary_names.load(); name; name = name->next)
    if (name->state.load() == io::TemporaryName::in_use) ::unlink(name->path);
}

}  // namespace soapfilm
