#include "soapfilm/run/kept_stages.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>
#include <vector>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/hash.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/core/ranks.h"
#include "soapfilm/error.h"
#include "soapfilm/platform/new_file.h"
#include "soapfilm/platform/scratch.h"
#include "soapfilm/run/checked_file.h"
#include "soapfilm/run/run.h"
#include "soapfilm/run/stage_state.h"
#include "soapfilm/version.h"

namespace soapfilm {

namespace {

namespace fs = std::filesystem;

/// What the kept stages follow from. Each rank keeps its own, those of as many ranks.
uint64_t hash_of(const PointCloud& cloud, const ReconstructParams& params, const Ranks* ranks) {
  Hash hash;
  hash.add(version);
  hash.add(to_json(params));
  hash.add(hash_of(cloud));
  if (ranks) hash.add(std::vector<int>{ranks->rank(), ranks->count()});
  return hash.value();
}

std::string level_name(int level) { return fmt::format("level_{}", level); }

constexpr const char* ending = ".stage";

}  // namespace

KeptStages::KeptStages(const PointCloud& cloud, const ReconstructParams& params, MemoryBudget& memory,
                       const Context& context)
    : memory_(memory), context_(context) {
  const Context::State& state = context.state();
  if (!state.resumes) return;
  if (state.scratch_folder.empty()) throw ParameterError("resume: needs a scratch folder, where stages are kept");
  check_scratch_folder(state.scratch_folder);
  prefix_ =
      (fs::path(state.scratch_folder) / fmt::format("soapfilm-{:016x}-", hash_of(cloud, params, ranks_of(context))))
          .string();
  context.state().kept_stages = prefix_;
}

std::string KeptStages::file(const std::string& stage) const { return prefix_ + stage + ending; }

int KeptStages::first_that_cannot(bool this_one) const {
  Ranks* const ranks = ranks_of(context_);
  if (!ranks) return this_one ? -1 : 0;
  const std::vector<uint8_t> all = of_all(*ranks, static_cast<uint8_t>(this_one));
  const auto first = std::find(all.begin(), all.end(), 0);
  return first == all.end() ? -1 : static_cast<int>(first - all.begin());
}

bool KeptStages::load(const std::string& stage, const std::function<void(std::istream&)>& read) {
  if (!on()) return false;
  std::error_code unknown;
  if (first_that_cannot(fs::exists(file(stage), unknown)) >= 0) return false;
  const auto do_again = [&](int rank, const char* why) {
    const Ranks* const ranks = ranks_of(context_);
    const std::string whose =
        ranks && ranks->rank() != rank ? fmt::format("stage {} of rank {}", stage, rank) : file(stage);
    context_.progress().warn(fmt::format("{}: {}; the stage is done again", whose, why));
    return false;
  };
  std::ifstream from(file(stage), std::ios::binary);
  if (const int rank = first_that_cannot(from.is_open() && is_whole(file(stage), context_)); rank >= 0)
    return do_again(rank, "not as it was written");
  const MemoryPlan before = memory_.plan();
  MemoryPlan plan;
  get(from, plan);
  if (from) memory_.take(plan);
  read(from);
  if (const int rank = first_that_cannot(!from.fail()); rank >= 0) {
    memory_.take(before);
    return do_again(rank, "cannot be read");
  }
  context_.progress().info(fmt::format("resume: {} from {}", stage, file(stage)));
  return true;
}

bool KeptStages::could_save(const std::string& stage, const std::function<void(std::ostream&)>& write) {
  const std::string& folder = context_.state().scratch_folder;
  NewFile part(file(stage));
  CheckedFile to(part.path());
  put(to.stream(), memory_.plan());
  write(to.stream());
  const bool is_written = to.close();
  check_scratch_files(folder);
  const uint64_t arrays = memory_.planned_disk_bytes() / 2 * 3;  // what is planned may be a third too little
  const bool leaves_room = free_disk_bytes(folder) >= arrays;
  return is_written && leaves_room && part.complete();
}

void KeptStages::save(const std::string& stage, const std::function<void(std::ostream&)>& write) {
  if (!on() || could_save(stage, write)) return;
  const std::string& folder = context_.state().scratch_folder;
  context_.progress().warn(fmt::format("scratch folder {}: stage {} cannot be kept beside the run's arrays, {} free",
                                       folder, stage, format_bytes(free_disk_bytes(folder))));
}

Orientation KeptStages::orient(const std::function<Orientation()>& make) {
  Orientation found;
  if (load("orient", [&](std::istream& from) { found = get_directions(from); })) {
    has_directions_ = true;
    for (const std::string& warning : found.report.warnings) context_.progress().warn(warning);
    return found;
  }
  return make();
}

void KeptStages::keep(const Orientation& found) {
  if (!has_directions_) save("orient", [&](std::ostream& to) { put_directions(to, found); });
}

Surface KeptStages::refine(const std::function<Surface()>& make) {
  Surface found;
  if (load("refine", [&](std::istream& from) { found = get_surface(from, context_); })) return found;
  found = make();
  if (!found.values().inside.are_by_brick()) save("refine", [&](std::ostream& to) { put_surface(to, found); });
  return found;
}

PyramidObserver KeptStages::watch(PyramidObserver user) {
  if (!on()) return user;
  user.known = [this](LevelReport& report, const MakeLevel& make) {
    std::optional<Level> level;
    const LevelReport fresh = report;
    if (load(level_name(report.level), [&](std::istream& from) { level = get_level(from, make, report, context_); }))
      return level;
    report = fresh;
    level.reset();
    return level;
  };
  user.keep = [this](const Level& level, const LevelReport& report) {
    save(level_name(report.level), [&](std::ostream& to) { put_level(to, level, report); });
  };
  return user;
}

void remove_kept_stages(const Context& context) {
  const fs::path prefix = std::exchange(context.state().kept_stages, {});
  if (prefix.empty()) return;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(prefix.parent_path(), ignored))
    if (entry.path().filename().string().starts_with(prefix.filename().string())) fs::remove(entry.path(), ignored);
}

}  // namespace soapfilm
