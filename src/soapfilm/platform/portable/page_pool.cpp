// Large arrays from the C++ library's allocator: set to zero explicitly, and freed whole.
#include "soapfilm/platform/page_pool.h"

#include <cstring>
#include <new>

#include "soapfilm/platform/array_bytes.h"

namespace soapfilm {

namespace {

constexpr std::align_val_t alignment{64};

}  // namespace

/// Keeps no blocks, only counts.
class SpareBlocks {
 public:
  ArrayBytes arrays;
};

ZeroedMemory PagePool::allocate(size_t bytes) const {
  auto* const address = static_cast<std::byte*>(::operator new(bytes, alignment));
  std::memset(address, 0, bytes);
  if (spare_) spare_->arrays.add(bytes);
  return ZeroedMemory(address, {bytes, spare_, -1});
}

void FreeZeroed::operator()(std::byte* memory) const {
  ::operator delete(memory, alignment);
  if (spare) spare->arrays.remove(bytes);
}

size_t release_pages(const ZeroedMemory&, size_t gone, size_t) { return gone; }

void fetch_pages(const ZeroedMemory&, size_t, size_t) {}

void PagePool::use_folder(const std::string&) const {}

bool PagePool::moves_pages() { return false; }

PagePool PagePool::make() {
  PagePool pool;
  pool.spare_ = std::make_shared<SpareBlocks>();
  return pool;
}

void PagePool::supply(void*, size_t) const {}

size_t PagePool::peak_bytes() const { return spare_ ? spare_->arrays.peak() : 0; }

size_t PagePool::peak_disk_bytes() const { return 0; }

void PagePool::restart_peak() const {
  if (spare_) spare_->arrays.restart_peak();
}

PagePool::Keep::Keep(const PagePool& pool) : spare_(pool.spare_) {}
PagePool::Keep::~Keep() = default;

}  // namespace soapfilm
