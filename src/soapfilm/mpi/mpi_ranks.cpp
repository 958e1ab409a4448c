#include "soapfilm/mpi/mpi_ranks.h"

#include <mpi.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <thread>
#include <utility>

namespace soapfilm {

namespace {

constexpr size_t largest_message = size_t{1} << 30;  // counts are of type int
constexpr int data_tag = 1, end_tag = 2, stop_tag = 3;
constexpr size_t longest_line = 2000;
constexpr auto longest_wait = std::chrono::seconds(20);  // for a rank to look whether others have failed

/// Launchers tell processes so that they are some of several.
bool is_launched() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"})
    if (std::getenv(name)) return true;
  return false;
}

/// Where all run on one machine Open MPI need not look for fast networks, which takes longer than the rest of its start
/// (0.2 s). A choice that the user has made is kept.
void look_for_no_network() {
  const char *all = std::getenv("OMPI_COMM_WORLD_SIZE"), *here = std::getenv("OMPI_COMM_WORLD_LOCAL_SIZE");
  if (all && here && std::string_view(all) == here) setenv("OMPI_MCA_pml", "ob1", 0);
}

/// What a rank tells the others when it ends.
struct EndMessage {
  int code = 0;
  int followed = 0;
  char line[longest_line] = {};
};

/// Spins at first: most waits are short. Then it lets others that want the core go first; then it leaves the core, for
/// longer and longer. Who sleeps wakes up late: with shorter spins two ranks waited twice as long.
class Patience {
 public:
  void wait() {
    constexpr int spins = 2000, turns_of_others = 20000, longest = 1000;  // microseconds
    if (++turns_ <= spins) return;
    if (turns_ <= turns_of_others) return std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::microseconds(std::min((turns_ - turns_of_others) / 10, longest)));
  }
  bool is_time_to_look() const { return turns_ % 16 == 0; }

 private:
  int turns_ = 0;
};

}  // namespace

struct MpiRanks::World {
  MPI_Comm data = MPI_COMM_NULL, ends = MPI_COMM_NULL;
  int rank = 0, count = 1, on_machine = 1;
  std::vector<MPI_Request> open;         ///< of the exchange in progress
  std::vector<bool> stopped;             ///< of each rank: whether it exchanges nothing any more
  std::vector<bool> ended;               ///< of each rank: whether its end is known
  std::vector<EndMessage> end_messages;  ///< if so
  bool failed = false;                   ///< one of them is not good
};

std::shared_ptr<MpiRanks> MpiRanks::join() {
  if (!is_launched()) return nullptr;
  look_for_no_network();
  int threads = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &threads);
  auto world = std::make_unique<World>();
  MPI_Comm_rank(MPI_COMM_WORLD, &world->rank);
  MPI_Comm_size(MPI_COMM_WORLD, &world->count);
  if (world->count == 1) {
    MPI_Finalize();
    return nullptr;
  }
  MPI_Comm_dup(MPI_COMM_WORLD, &world->data);
  MPI_Comm_dup(MPI_COMM_WORLD, &world->ends);
  MPI_Comm machine = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  MPI_Comm_size(machine, &world->on_machine);
  MPI_Comm_free(&machine);
  world->stopped.resize(static_cast<size_t>(world->count));
  world->ended.resize(static_cast<size_t>(world->count));
  world->end_messages.resize(static_cast<size_t>(world->count));
  return std::shared_ptr<MpiRanks>(new MpiRanks(std::move(world)));
}

MpiRanks::MpiRanks(std::unique_ptr<World> world) : Ranks(world->rank, world->count), world_(std::move(world)) {}
MpiRanks::~MpiRanks() = default;

int MpiRanks::on_this_machine() const { return world_->on_machine; }

/// Receives the ends that have arrived, and what says that a rank stops.
void MpiRanks::look_for_failures() {
  for (;;) {
    int there = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, world_->ends, &there, &status);
    if (!there) return;
    const auto from = static_cast<size_t>(status.MPI_SOURCE);
    world_->stopped[from] = true;
    if (status.MPI_TAG == stop_tag) {
      MPI_Recv(nullptr, 0, MPI_BYTE, status.MPI_SOURCE, stop_tag, world_->ends, MPI_STATUS_IGNORE);
      world_->failed = true;
      continue;
    }
    EndMessage& end = world_->end_messages[from];
    MPI_Recv(&end, sizeof end, MPI_BYTE, status.MPI_SOURCE, end_tag, world_->ends, MPI_STATUS_IGNORE);
    world_->ended[from] = true;
    world_->failed = world_->failed || end.code != 0;
  }
}

void MpiRanks::pass(const std::vector<Message>& out, const std::vector<Message>& in) {
  look_for_failures();
  if (world_->failed) throw RankGaveUp();
  std::vector<MPI_Request>& open = world_->open;
  const auto begin = [&](const Message& message, auto&& start) {
    auto* data = static_cast<std::byte*>(message.data);
    for (size_t done = 0; done < message.bytes; done += largest_message) {
      open.push_back(MPI_REQUEST_NULL);
      start(data + done, static_cast<int>(std::min(largest_message, message.bytes - done)), message.rank, &open.back());
    }
  };
  for (const Message& message : in)
    begin(message, [&](std::byte* data, int bytes, int rank, MPI_Request* request) {
      MPI_Irecv(data, bytes, MPI_BYTE, rank, data_tag, world_->data, request);
    });
  const size_t receives = open.size();
  for (const Message& message : out)
    begin(message, [&](std::byte* data, int bytes, int rank, MPI_Request* request) {
      MPI_Isend(data, bytes, MPI_BYTE, rank, data_tag, world_->data, request);
    });
  try {
    complete_open();
  } catch (...) {
    stop(receives);
    throw;
  }
  open.clear();
}

void MpiRanks::complete_open() {
  std::vector<MPI_Request>& open = world_->open;
  Patience patience;
  for (int done = 0;;) {
    MPI_Testall(static_cast<int>(open.size()), open.data(), &done, MPI_STATUSES_IGNORE);
    if (done) return;
    patience.wait();
    if (!patience.is_time_to_look()) continue;
    look_for_failures();
    if (world_->failed) throw RankGaveUp();
    if (while_waiting) while_waiting();
  }
}

/// Before the memory of what is exchanged is freed: once all ranks have stopped, none reads or writes it any more. A
/// rank stops when it receives nothing any more: what has begun to arrive cannot be cancelled, and who sends it needs
/// its memory until then.
void MpiRanks::stop(size_t receives) {
  std::vector<MPI_Request>& open = world_->open;
  for (size_t k = 0; k < receives; ++k) MPI_Cancel(&open[k]);
  const auto begin = std::chrono::steady_clock::now();
  Patience patience;
  const auto wait = [&] {
    // The rank that failed waits for a shorter time: it has the line.
    if (std::chrono::steady_clock::now() - begin > longest_wait * 5 / 4) abort({});
    patience.wait();
  };
  for (int done = 0;; wait()) {
    MPI_Testall(static_cast<int>(receives), open.data(), &done, MPI_STATUSES_IGNORE);
    if (done) break;
  }
  for (int r = 0; r < count(); ++r)
    if (r != rank()) {
      MPI_Request sent = MPI_REQUEST_NULL;
      MPI_Isend(nullptr, 0, MPI_BYTE, r, stop_tag, world_->ends, &sent);
      MPI_Request_free(&sent);
    }
  world_->stopped[static_cast<size_t>(rank())] = true;
  for (;; wait()) {
    look_for_failures();
    if (std::find(world_->stopped.begin(), world_->stopped.end(), false) == world_->stopped.end()) break;
  }
  open.erase(open.begin(), open.begin() + static_cast<std::ptrdiff_t>(receives));
}

MpiRanks::End MpiRanks::leave(const End& own) {
  const auto self = static_cast<size_t>(rank());
  EndMessage& end = world_->end_messages[self];
  end.code = own.code;
  end.followed = own.followed;
  own.line.copy(end.line, longest_line - 1);
  world_->ended[self] = true;
  std::vector<MPI_Request> sent;
  for (int r = 0; r < count(); ++r)
    if (r != rank()) {
      sent.push_back(MPI_REQUEST_NULL);
      MPI_Isend(&end, sizeof end, MPI_BYTE, r, end_tag, world_->ends, &sent.back());
    }
  // Others may do something long before they end; after a failure nothing does.
  Patience patience;
  auto failed_at = std::chrono::steady_clock::time_point::max();
  for (int done = 0;;) {
    MPI_Testall(static_cast<int>(sent.size()), sent.data(), &done, MPI_STATUSES_IGNORE);
    look_for_failures();
    if (done && std::find(world_->ended.begin(), world_->ended.end(), false) == world_->ended.end()) break;
    const auto now = std::chrono::steady_clock::now();
    if ((world_->failed || own.code != 0) && failed_at > now) failed_at = now;
    if (now > failed_at && now - failed_at > longest_wait) abort(own);
    patience.wait();
  }
  // What was on its way when a rank gave up is of no use any more.
  for (MPI_Request& request : world_->open)
    if (request != MPI_REQUEST_NULL) {
      MPI_Cancel(&request);
      MPI_Request_free(&request);
    }
  return first_failure(own);
}

/// Of those whose end is known.
MpiRanks::End MpiRanks::first_failure(const End& own) const {
  End first = own;
  for (int r = count(); r-- > 0;) {
    const EndMessage& other = world_->end_messages[static_cast<size_t>(r)];
    const std::string whose = r > 0 ? "rank " + std::to_string(r) + ": " : "";
    if (other.code != 0 && !other.followed) first = {other.code, whose + other.line, false};
  }
  return first;
}

/// Where a rank does not answer, as it does something long, nobody else may be left to print the line.
void MpiRanks::abort(const End& own) const {
  const End first = first_failure(own);
  if (!first.line.empty()) std::fprintf(stderr, "soapfilm: %s\n", first.line.c_str());
  MPI_Abort(MPI_COMM_WORLD, first.code != 0 ? first.code : 1);
  std::_Exit(1);  // it does not return
}

void MpiRanks::close() {
  alarm(static_cast<unsigned>(longest_wait.count()));  // should the library wait for a rank that is gone
  MPI_Finalize();
  alarm(0);
}

}  // namespace soapfilm
