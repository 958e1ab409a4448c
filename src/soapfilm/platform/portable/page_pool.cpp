// Large arrays from the C++ library's allocator: set to zero explicitly, and freed whole.
#include "soapfilm/platform/page_pool.h"

#include <atomic>
#include <cstring>
#include <new>

namespace soapfilm {

namespace {

constexpr std::align_val_t alignment{64};

}  // namespace

/// Keeps no blocks, only counts.
class SpareBlocks {
 public:
  void count(size_t bytes) {
    const size_t now = taken_.fetch_add(bytes) + bytes;
    for (size_t most = most_.load(); most < now && !most_.compare_exchange_weak(most, now);) {
    }
  }
  void count_freed(size_t bytes) { taken_ -= bytes; }
  size_t most() const { return most_; }
  void restart_peak() { most_ = taken_.load(); }

 private:
  std::atomic<size_t> taken_{0};  // by living arrays
  std::atomic<size_t> most_{0};   // maximum of taken_ so far
};

ZeroedMemory PagePool::allocate(size_t bytes) const {
  auto* const address = static_cast<std::byte*>(::operator new(bytes, alignment));
  std::memset(address, 0, bytes);
  if (spare_) spare_->count(bytes);
  return ZeroedMemory(address, {bytes, spare_});
}

void FreeZeroed::operator()(std::byte* memory) const {
  ::operator delete(memory, alignment);
  if (spare) spare->count_freed(bytes);
}

size_t give_back(const ZeroedMemory&, size_t gone, size_t) { return gone; }

bool PagePool::moves_pages() { return false; }

PagePool PagePool::make() {
  PagePool pool;
  pool.spare_ = std::make_shared<SpareBlocks>();
  return pool;
}

void PagePool::serve(void*, size_t) const {}

size_t PagePool::peak_bytes() const { return spare_ ? spare_->most() : 0; }

void PagePool::restart_peak() const {
  if (spare_) spare_->restart_peak();
}

PagePool::Keep::Keep(const PagePool& pool) : spare_(pool.spare_) {}
PagePool::Keep::~Keep() = default;

}  // namespace soapfilm
