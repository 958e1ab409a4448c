#include "soapfilm/io/bytes/rank_blocks.h"

#include <algorithm>
#include <array>
#include <random>
#include <type_traits>
#include <utility>

#include "soapfilm/io/bytes/file_descriptor.h"
#include "soapfilm/io/bytes/temporary_names.h"
#include "soapfilm/platform/new_file.h"

namespace soapfilm::io {

namespace {

constexpr size_t most_writers = 16;  // a round of blocks is in rank 0's memory

/// What the file begins with until it is known who writes it: who reads this has the same file.
using Mark = std::array<uint32_t, 4>;

/// From rank 0 to another one.
struct Order {
  enum Kind : uint64_t { temporary, open, write, close, end };
  Kind kind = end;
  uint64_t offset = 0;  ///< of write
  uint64_t bytes = 0;   ///< that follow: the block; the path of open, and of temporary, which goes if the run fails
  Mark mark{};          ///< of open
};

template <class T>
requires std::is_trivially_copyable_v<T> Ranks::Message message(int rank, T& value) {
  return {rank, &value, sizeof value};
}
Ranks::Message message(int rank, std::string& bytes) { return {rank, bytes.data(), bytes.size()}; }

/// An order that a path follows. Returns the byte with which each other rank answers, by rank.
std::vector<uint8_t> send_path(Order order, std::string path, Ranks& ranks) {
  order.bytes = path.size();
  std::vector<uint8_t> answers(static_cast<size_t>(ranks.count()));
  std::vector<Ranks::Message> out, in;
  for (int r = 1; r < ranks.count(); ++r) {
    out.push_back(message(r, order));
    out.push_back(message(r, path));
    in.push_back(message(r, answers[static_cast<size_t>(r)]));
  }
  ranks.exchange(out, in);
  return answers;
}

/// The files of another rank, one after the other.
class BlockWriter {
 public:
  ~BlockWriter() {
    // The run has failed: rank 0 may have been killed, and left them.
    for (const auto& [path, slot] : names_) {
      if (!is_done_) ::unlink(path.c_str());
      forget_temporary(slot);
    }
  }

  /// A file that is to have this name until it is complete.
  void remember(const std::string& path) { names_.emplace_back(path, remember_temporary(path)); }
  /// Whether the path is the file with this mark.
  bool open(const std::string& path, const Mark& expected) {
    error_ = 0;
    struct stat status {};
    const bool can_be = ::stat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode) &&
                        status.st_size == static_cast<off_t>(sizeof(Mark));
    if (!can_be) return false;  // nothing is done to a file of others
    file_.reset(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
    Mark mark{};
    const bool is_same =
        file_.is_open() && ::pread(file_.get(), &mark, sizeof mark, 0) == sizeof mark && mark == expected;
    if (!is_same) file_.close();
    return is_same;
  }
  void write(std::string_view block, uint64_t offset) {
    if (error_ == 0) error_ = write_all(file_.get(), block, offset);
  }
  /// Returns 0 or the first error number of the file.
  int close() {
    if (error_ == 0) error_ = store_file(file_.get());
    if (file_.close() != 0 && error_ == 0) error_ = errno;
    return error_;
  }
  void end() { is_done_ = true; }

 private:
  FileDescriptor file_;
  int error_ = 0;
  bool is_done_ = false;
  std::vector<std::pair<std::string, TemporaryName*>> names_;
};

}  // namespace

RankBlocks::RankBlocks(Ranks& ranks, int file, std::string path, bool has_name)
    : ranks_(ranks), file_(file), path_(std::move(path)), has_name_(has_name) {
  blocks_.resize(std::min(static_cast<size_t>(ranks_.count()), most_writers));
}

int RankBlocks::append(std::string_view bytes) {
  while (!bytes.empty()) {
    if (writers_.size() == 1) return write_own(bytes);
    std::unique_ptr<char[]>& block = blocks_[used_ / block_bytes];
    if (!block) block = std::make_unique_for_overwrite<char[]>(block_bytes);
    const size_t begin = used_ % block_bytes, some = bytes.copy(block.get() + begin, block_bytes - begin);
    bytes.remove_prefix(some);
    used_ += some;
    if (used_ < blocks_.size() * block_bytes) continue;
    if (const int error = writers_.empty() ? find_writers() : 0) return error;
    if (const int error = write_round()) return error;
  }
  return 0;
}

/// Asks the others to open the file.
int RankBlocks::find_writers() {
  Order order;
  order.kind = Order::open;
  std::random_device random;
  for (uint32_t& part : order.mark) part = random();
  if (const int error = write_all(file_, {reinterpret_cast<const char*>(&order.mark), sizeof order.mark}, 0))
    return error;
  if (has_name_)  // on a network's file system others see what is stored
    if (const int error = store_file(file_)) return error;
  const std::vector<uint8_t> has_file = send_path(order, path_, ranks_);
  for (int r = 1; r < ranks_.count(); ++r)
    if (has_file[static_cast<size_t>(r)] != 0) have_file_.push_back(r);
  // Some of them, evenly: ranks of one machine are mostly next to each other.
  const size_t others = std::min(have_file_.size(), most_writers - 1);
  writers_.push_back(0);
  for (size_t k = 0; k < others; ++k) writers_.push_back(have_file_[k * have_file_.size() / others]);
  return 0;
}

/// Of the round.
std::string_view RankBlocks::block(size_t k) const {
  return {blocks_[k].get(), std::min(block_bytes, used_ - k * block_bytes)};
}

int RankBlocks::write_round() {
  const size_t count = (used_ + block_bytes - 1) / block_bytes;
  std::vector<Order> orders(count);
  std::vector<Ranks::Message> out;
  for (size_t k = 0; k < count; ++k) {
    const int writer = writers_[k % writers_.size()];
    if (writer == 0) continue;
    orders[k].kind = Order::write;
    orders[k].offset = written_ + k * block_bytes;
    orders[k].bytes = block(k).size();
    out.push_back(message(writer, orders[k]));
    out.push_back({writer, blocks_[k].get(), block(k).size()});
  }
  ranks_.exchange(out, {});
  int error = 0;
  for (size_t k = 0; k < count && error == 0; k += writers_.size())
    error = write_all(file_, block(k), written_ + k * block_bytes);
  written_ += used_;
  used_ = 0;
  return error;
}

int RankBlocks::write_own(std::string_view bytes) {
  const int error = write_all(file_, bytes, written_);
  written_ += bytes.size();
  return error;
}

int RankBlocks::finish() {
  if (writers_.empty()) writers_.push_back(0);
  if (const int error = write_round()) return error;
  Order order;
  order.kind = Order::close;
  std::vector<int32_t> errors(have_file_.size());
  std::vector<Ranks::Message> out, in;
  for (size_t k = 0; k < have_file_.size(); ++k) {
    out.push_back(message(have_file_[k], order));
    in.push_back(message(have_file_[k], errors[k]));
  }
  // The others store it at the same time. They are heard last, for one that gave up has removed a file with a name.
  ranks_.exchange(out, {});
  const int own_error = store_file(file_);
  ranks_.exchange({}, in);
  if (own_error != 0) return own_error;
  const auto first = std::find_if(errors.begin(), errors.end(), [](int error) { return error != 0; });
  return first == errors.end() ? 0 : *first;
}

void write_blocks(Ranks& ranks) {
  BlockWriter writer;
  std::string bytes;
  const auto answer = [&](auto value) { ranks.exchange({message(0, value)}, {}); };
  for (;;) {
    Order order;
    ranks.exchange({}, {message(0, order)});
    bytes.resize(static_cast<size_t>(order.bytes));
    if (order.bytes > 0) ranks.exchange({}, {message(0, bytes)});
    switch (order.kind) {
      case Order::temporary:
        writer.remember(bytes);
        answer(uint8_t{1});
        break;
      case Order::open:
        answer(uint8_t{writer.open(bytes, order.mark)});
        break;
      case Order::write:
        writer.write(bytes, order.offset);
        break;
      case Order::close:
        answer(int32_t{writer.close()});
        break;
      case Order::end:
        return writer.end();
    }
  }
}

void tell_temporary(Ranks& ranks, const std::string& path) {
  Order order;
  order.kind = Order::temporary;
  send_path(order, path, ranks);
}

void end_blocks(Ranks& ranks) {
  Order order;
  std::vector<Ranks::Message> out;
  for (int r = 1; r < ranks.count(); ++r) out.push_back(message(r, order));
  ranks.exchange(out, {});
}

}  // namespace soapfilm::io
