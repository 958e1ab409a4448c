#include "soapfilm/simplify/rounds.h"

#include <algorithm>
#include <array>
#include <queue>

#include "soapfilm/core/parallel.h"
#include "soapfilm/simplify/cells.h"
#include "soapfilm/simplify/placement.h"

namespace soapfilm {

namespace {

/// Sides are whole numbers of the cells of ThinPlaces, so that no two tiles share one.
struct Round {
  double side, shift;
};
constexpr double whole = 0x1p21;
constexpr std::array<Round, 5> rounds{{{32, 0}, {32, 16}, {64, 16}, {128, 32}, {whole, 0x1p20}}};
constexpr size_t attempts_per_check = 256;

struct Candidate {
  double cost;
  uint32_t a, b, versions;
  bool operator<(const Candidate& o) const {  // the cheapest is the largest
    return cost != o.cost ? cost > o.cost : a != o.a ? a > o.a : b > o.b;
  }
};

class TileRun {
 public:
  TileRun(CollapseRun& run, const Tile& tile, const std::vector<uint8_t>& waiting, std::vector<uint8_t>& deferred,
          CollapseLog& log, const Context& context)
      : run_(run), now_(run.now), tile_(tile), waiting_(waiting), deferred_(deferred), log_(log), context_(context) {}

  void collapse(const uint32_t* begin, const uint32_t* end) {
    for (const uint32_t* v = begin; v != end; ++v)
      for_neighbors(*v, [&](uint32_t u) {
        if (!waiting_[*v] && !waiting_[u]) return;
        if (!tile_.holds(now_.position[u])) {
          deferred_[*v] = 1;
        } else if (*v < u) {
          push(*v, u);
        }
      });
    Trial trial(run_, tile_);
    for (size_t attempts = 0; !queue_.empty(); ++attempts) {
      if (attempts % attempts_per_check == 0) context_.check();
      const Candidate next = queue_.top();
      queue_.pop();
      if (next.versions != now_.version[next.a] + now_.version[next.b]) continue;
      if (!now_.mesh.is_used(next.a) || !now_.mesh.is_used(next.b)) continue;
      const Trial::Outcome outcome = trial.attempt(next.a, next.b, log_);
      if (outcome == Trial::Outcome::beyond_tile) deferred_[next.a] = 1;
      if (outcome != Trial::Outcome::done) continue;
      const uint32_t kept = trial.kept();
      for_neighbors(kept, [&](uint32_t u) {
        if (tile_.holds(now_.position[u])) {
          push(kept, u);
        } else {
          deferred_[kept] = 1;
        }
      });
    }
  }

 private:
  template <class Visit>
  void for_neighbors(uint32_t v, Visit&& visit) const {
    now_.mesh.for_fan(v, [&](uint32_t h) {
      visit(now_.mesh.to(h));
      const uint32_t last = Connectivity::previous(h);
      if (now_.mesh.twin(last) == Connectivity::none) visit(now_.mesh.from(last));
    });
  }

  void push(uint32_t a, uint32_t b) {
    if (a > b) std::swap(a, b);
    Quadric sum = now_.quadric[a];
    sum += now_.quadric[b];
    const double cost = collapse_cost(sum, now_.position[a], now_.position[b]);
    constexpr double hopeless = 16;  // times the squared distance, of the mean over all planes: tests would fail
    if (cost <= hopeless * run_.distance * run_.distance * sum.weight() + 1e-300)
      queue_.push({cost, a, b, now_.version[a] + now_.version[b]});
  }

  CollapseRun& run_;
  CollapsedMesh& now_;
  Tile tile_;
  const std::vector<uint8_t>& waiting_;
  std::vector<uint8_t>& deferred_;
  CollapseLog& log_;
  const Context& context_;
  std::priority_queue<Candidate> queue_;
};

/// Vertices by tile, tiles in the order of their first vertex.
struct Tiles {
  std::vector<Tile> tiles;
  std::vector<size_t> begin;
  std::vector<uint32_t> vertices;

  Tiles(const CollapsedMesh& now, const Round& round) {
    CellTable table;
    std::vector<uint32_t> tile_of(now.position.size(), CellTable::none);
    const Vec3d shift{round.shift, round.shift, round.shift};
    for (uint32_t v = 0; v < tile_of.size(); ++v) {
      if (!now.mesh.is_used(v)) continue;
      const Vec3i cell = cell_of(now.position[v] + shift, 1 / round.side);
      tile_of[v] = table.insert(cell_key(cell));
      if (tile_of[v] == tiles.size()) {
        const Vec3d lo = Vec3d(cell) * round.side - shift;
        const Vec3d edge{1e-6, 1e-6, 1e-6};  // so that nothing in a tile reaches a cell of the next
        tiles.push_back({lo + edge, lo + Vec3d{round.side, round.side, round.side} - edge});
        begin.push_back(0);
      }
      ++begin[tile_of[v]];
    }
    begin.insert(begin.begin(), 0);
    for (size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
    vertices.resize(begin.back());
    std::vector<size_t> next(begin.begin(), begin.end() - 1);
    for (uint32_t v = 0; v < tile_of.size(); ++v)
      if (tile_of[v] != CellTable::none) vertices[next[tile_of[v]]++] = v;
  }
};

}  // namespace

void collapse_edges(CollapseRun& run, std::vector<uint8_t> waiting, const Context& context) {
  CollapsedMesh& now = run.now;
  std::vector<uint8_t> deferred(now.position.size());
  for (size_t r = 0; r < rounds.size(); ++r) {
    const Tiles tiles(now, rounds[r]);
    if (now.next_stamp > ~uint32_t{0} - tiles.vertices.size()) return;  // no numbers are left
    std::vector<CollapseLog> logs(tiles.tiles.size());
    for (size_t i = 0; i < logs.size(); ++i) logs[i].base = now.next_stamp + static_cast<uint32_t>(tiles.begin[i]);
    now.next_stamp += static_cast<uint32_t>(tiles.vertices.size());
    parallel_for(context, logs.size(), 1, [&](size_t i) {
      TileRun(run, tiles.tiles[i], waiting, deferred, logs[i], context)
          .collapse(tiles.vertices.data() + tiles.begin[i], tiles.vertices.data() + tiles.begin[i + 1]);
    });
    for (CollapseLog& log : logs)
      if (!log.collapses.empty()) now.logs.push_back(std::move(log));
    waiting.swap(deferred);
    std::fill(deferred.begin(), deferred.end(), uint8_t{0});
    context.progress().advance(static_cast<double>(r + 1) / rounds.size(), {});
  }
}

}  // namespace soapfilm
