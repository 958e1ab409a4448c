// Ranks (core/ranks.h) that are threads of one process, each with its own arrays.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/random.h"
#include "soapfilm/core/ranks.h"
#include "soapfilm/error.h"
#include "support/sanitized.h"

namespace soapfilm::test {

/// What is on its way from rank to rank.
class Mail {
 public:
  void send(int from, int to, const Ranks::Message& message) {
    const std::lock_guard lock(mutex_);
    const auto* bytes = static_cast<const std::byte*>(message.data);
    boxes_[{from, to}].emplace_back(bytes, bytes + message.bytes);
    arrived_.notify_all();
  }
  void receive(int from, int to, const Ranks::Message& message) {
    std::unique_lock lock(mutex_);
    auto& box = boxes_[{from, to}];
    arrived_.wait(lock, [&] { return gave_up_ || !box.empty(); });
    if (gave_up_) throw Cancelled();
    if (box.front().size() != message.bytes) throw std::logic_error("a message of another size");
    std::memcpy(message.data, box.front().data(), message.bytes);
    box.pop_front();
  }
  void give_up() {
    const std::lock_guard lock(mutex_);
    gave_up_ = true;
    arrived_.notify_all();
  }
  bool empty() const {
    for (const auto& [way, box] : boxes_)
      if (!box.empty()) return false;
    return true;
  }

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::map<std::pair<int, int>, std::deque<std::vector<std::byte>>> boxes_;
  bool gave_up_ = false;
};

/// Where ranks cut: evenly, or anywhere.
struct Cuts {
  uint64_t seed = 0;  ///< 0: evenly
};

class ThreadRank final : public Ranks {
 public:
  ThreadRank(int rank, int count, Mail& mail, Cuts cuts) : Ranks(rank, count), mail_(mail), cuts_(cuts) {}

  int least_layers() const override { return 1; }
  /// Slabs of one layer and empty ones are likely.
  std::vector<size_t> cut(const std::vector<size_t>& bricks_of_layer) const override {
    if (cuts_.seed == 0) return Ranks::cut(bricks_of_layer);
    Random random(cuts_.seed + bricks_of_layer.size());
    std::vector<size_t> cut{0, bricks_of_layer.size()};
    while (cut.size() <= static_cast<size_t>(count())) {
      const size_t next = random.next() % 2 == 0 ? random.next() % (bricks_of_layer.size() + 1)
                                                 : cut[random.next() % cut.size()] + random.next() % 2;
      cut.push_back(std::min(next, bricks_of_layer.size()));
    }
    std::sort(cut.begin(), cut.end());
    return cut;
  }

 private:
  void pass(const std::vector<Message>& out, const std::vector<Message>& in) override {
    for (const Message& message : out) mail_.send(rank(), message.rank, message);
    for (const Message& message : in) mail_.receive(message.rank, rank(), message);
  }

  Mail& mail_;
  Cuts cuts_;
};

/// Bytes that one of the ranks sends at least where slabs are even: without slabs they send their times alone.
constexpr uint64_t least_traffic = sanitized ? 10000 : 100000;  // shapes are small under sanitizers

/// body(context) on each rank, on so many threads each; returns what it gave, by rank. Rethrows the exception of the
/// lowest rank that failed by itself.
template <class Result>
std::vector<Result> on_ranks(int count, int threads, Cuts cuts, const std::function<Result(const Context&)>& body) {
  Mail mail;
  std::vector<Result> results(static_cast<size_t>(count));
  std::vector<std::exception_ptr> errors(static_cast<size_t>(count));
  std::vector<uint64_t> sent(static_cast<size_t>(count));
  {
    std::vector<std::jthread> running;
    for (int r = 0; r < count; ++r)
      running.emplace_back([&, r] {
        try {
          const Context context(threads);
          context.state().ranks = std::make_shared<ThreadRank>(r, count, mail, cuts);
          results[static_cast<size_t>(r)] = body(context);
          sent[static_cast<size_t>(r)] = ranks_of(context)->traffic().bytes;
        } catch (const Cancelled&) {
        } catch (...) {
          errors[static_cast<size_t>(r)] = std::current_exception();
          mail.give_up();
        }
      });
  }
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
  if (count > 1 && cuts.seed == 0 && *std::max_element(sent.begin(), sent.end()) < least_traffic)
    throw std::logic_error("the ranks had nothing to share");
  if (!mail.empty()) throw std::logic_error("messages that nobody received");
  return results;
}

/// Expects of ranks of many numbers, on threads, with even and with random cuts, what one process gives.
template <class Outcome>
void expect_same_on_ranks(const std::function<Outcome(const Context&)>& run) {
  const Outcome alone = run(Context(1));
  struct Group {
    int count, threads;
  };
  for (const Group group : {Group{1, 1}, Group{2, 1}, Group{3, 1}, Group{4, 1}, Group{7, 1}, Group{2, 2}})
    for (const Outcome& of_rank : on_ranks<Outcome>(group.count, group.threads, {}, run))
      EXPECT_EQ(of_rank, alone) << group.count << " ranks, " << group.threads << " threads";
  for (uint64_t cut = 1; cut <= 8; ++cut)
    for (const Outcome& of_rank : on_ranks<Outcome>(2 + static_cast<int>(cut % 5), 1, {cut}, run))
      EXPECT_EQ(of_rank, alone) << "cut " << cut;
}

}  // namespace soapfilm::test
