#include "soapfilm/context.h"

#include <fmt/core.h>

#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "soapfilm/core/context_state.h"
#include "soapfilm/error.h"

namespace soapfilm {

void PartOfProgress::advance(double fraction, std::string_view detail) {
  if (whole) whole->advance(begin + fraction * (end - begin), detail);
}
void PartOfProgress::info(const std::string& line) {
  if (whole) whole->info(line);
}
void PartOfProgress::detail(const std::string& line) {
  if (whole) whole->detail(line);
}
void PartOfProgress::warn(const std::string& line) {
  if (whole) whole->warn(line);
}

namespace {

int checked_threads(int count) {
  if (count < 0) throw ParameterError(fmt::format("threads = {}, must be >= 1, or 0 for all", count));
  return count;
}

}  // namespace

Context::State::State(int thread_count, const std::string& simd_target, Progress* progress)
    : reports(progress ? progress : &part),
      stopped_by(reports),
      kernels(kernels_for(simd_target)),
      threads(std::make_shared<Threads>(checked_threads(thread_count))),
      pages(PagePool::make()) {}

Context::State::State(const State& parent, Progress* whole, double begin, double end)
    : reports(&part),
      stopped_by(parent.stopped_by),
      kernels(parent.kernels),
      device(parent.device),
      ranks(parent.ranks),
      threads(parent.threads),
      pages(parent.pages),
      memory_limit(parent.memory_limit),
      scratch_folder(parent.scratch_folder),
      move_vectors(parent.move_vectors) {
  part.whole = whole;
  part.begin = begin;
  part.end = end;
}

Context::State::State(const State& parent, std::shared_ptr<const Device> other_device)
    : State(parent, parent.reports, 0, 1) {
  device = std::move(other_device);
}

Context::Context(int threads, const std::string& simd) : state_(std::make_unique<State>(threads, simd, nullptr)) {}
Context::Context(int threads, Progress& progress, const std::string& simd)
    : state_(std::make_unique<State>(threads, simd, &progress)) {}
Context::Context(std::unique_ptr<State> state) : state_(std::move(state)) {}
Context::~Context() = default;

double Context::cpu_seconds() const {
  return state_->threads->helpers_time().seconds() + 1e-9 * static_cast<double>(thread_cpu_time());
}

int Context::threads() const { return state_->threads->count(); }
Progress& Context::progress() const { return *state_->reports; }
void Context::check() const { state_->stopped_by->check(); }

void Context::limit_memory(std::optional<size_t> bytes) { state_->memory_limit = bytes; }
std::optional<size_t> Context::memory_limit() const { return state_->memory_limit; }
void Context::set_scratch_folder(std::string folder) { state_->scratch_folder = std::move(folder); }
std::string Context::scratch_folder() const {
  if (!state_->scratch_folder.empty()) return state_->scratch_folder;
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  if (error) throw OutputError(fmt::format("the folder for temporary files, by $TMPDIR: {}", error.message()));
  return folder.string();
}

namespace {

Context without_ranks(const Context& context, Progress* whole) {
  auto state = std::make_unique<Context::State>(context.state(), whole, 0, 1);
  state->ranks = nullptr;
  return Context(std::move(state));
}

}  // namespace

Context silenced(const Context& context) { return without_ranks(context, nullptr); }
Context alone(const Context& context) { return without_ranks(context, context.state().reports); }
Context part_of(const Context& context, double begin, double end) {
  return Context(std::make_unique<Context::State>(context.state(), context.state().reports, begin, end));
}
Context on_device(const Context& context, std::shared_ptr<const Device> device) {
  return Context(std::make_unique<Context::State>(context.state(), std::move(device)));
}

}  // namespace soapfilm
