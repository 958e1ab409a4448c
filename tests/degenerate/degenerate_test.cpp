// The whole program on thousands of degenerate clouds: it ends with a mesh that keeps its promise, or says in one line
// why not, and leaves nothing. SOAPFILM_FULL=1: fifty times as many; SOAPFILM_CASE=NUMBER: that one alone, told.
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

#include "cases.h"
#include "cli/program.h"
#include "judge.h"
#include "soapfilm/io.h"
#include "soapfilm/reconstruct.h"
#include "support/process.h"
#include "support/sanitized.h"

// Of AddressSanitizer; absent without it.
extern "C" __attribute__((weak)) void __sanitizer_set_death_callback(void (*callback)());

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

std::FILE* captured = nullptr;  ///< what the program writes to standard error
int real_stderr = -1;
std::string running;  ///< the case, for the last words of a crash

/// Says which case the program died of, and what it had said. (Called by a dying process: its work is done.)
extern "C" void tell_case() {
  if (real_stderr < 0) return;
  const auto say = [](const char* text, size_t size) { return ::write(real_stderr, text, size) > 0; };
  say(running.data(), running.size());
  char part[4096];
  ::lseek(::fileno(captured), 0, SEEK_SET);
  for (ssize_t got; (got = ::read(::fileno(captured), part, sizeof part)) > 0 && say(part, static_cast<size_t>(got));) {
  }
}
extern "C" void tell_case_and_die(int signal) {
  tell_case();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// While it lives, standard error goes to a file.
class CapturedErrors {
 public:
  CapturedErrors() : file_(std::tmpfile()) {
    std::fflush(stderr);
    captured = file_;
    real_stderr = ::dup(STDERR_FILENO);
    ::dup2(::fileno(file_), STDERR_FILENO);
    if (__sanitizer_set_death_callback) __sanitizer_set_death_callback(tell_case);
    std::signal(SIGABRT, tell_case_and_die);
    if (!__sanitizer_set_death_callback)
      for (const int signal : {SIGSEGV, SIGFPE, SIGBUS, SIGILL}) std::signal(signal, tell_case_and_die);
  }
  ~CapturedErrors() {
    std::fflush(stderr);
    ::dup2(real_stderr, STDERR_FILENO);
    ::close(std::exchange(real_stderr, -1));
    std::fclose(file_);
  }
  CapturedErrors(const CapturedErrors&) = delete;
  CapturedErrors& operator=(const CapturedErrors&) = delete;

  std::string text() const {
    std::fflush(stderr);
    std::string all(static_cast<size_t>(::lseek(::fileno(file_), 0, SEEK_END)), '\0');
    const ssize_t got = ::pread(::fileno(file_), all.data(), all.size(), 0);
    all.resize(got > 0 ? static_cast<size_t>(got) : 0);
    return all;
  }

 private:
  std::FILE* file_;
};

struct Ending {
  int code = 0;
  std::string errors;
  std::string mesh;  ///< bytes of the file; empty: there is none
};

Ending run_program(const TemporaryFolder& folder, const DegenerateCase& one, int threads, bool report) {
  std::vector<std::string> command{"soapfilm", "reconstruct", folder.file(one.input), "-o", folder.file(one.output),
                                   "-q",       "--threads",   std::to_string(threads)};
  command.insert(command.end(), one.options.begin(), one.options.end());
  if (report) command.insert(command.end(), {"--report", folder.file("report.json")});
  running = fmt::format("case {}: {}\n", one.number, fmt::join(command, " "));
  std::vector<char*> arguments;
  for (std::string& argument : command) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  std::filesystem::remove(folder.file(one.output));
  Ending ending;
  const CapturedErrors errors;
  ending.code = cli::program(static_cast<int>(command.size()), arguments.data());
  ending.errors = errors.text();
  if (std::filesystem::exists(folder.file(one.output))) ending.mesh = read_file(folder.file(one.output));
  return ending;
}

/// Warnings, and of a failure one line more.
std::string broken_message_law(const Ending& ending) {
  std::istringstream lines(ending.errors);
  size_t messages = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("soapfilm: ")) return "a line on standard error that is no message: " + line;
    messages += !line.starts_with("soapfilm: warning: ");
  }
  if (messages != (ending.code != 0)) return fmt::format("{} messages", messages);
  return "";
}

std::string broken_law(const TemporaryFolder& folder, const DegenerateCase& one, const Ending& ending) {
  if (ending.code != 0 && ending.code != 2 && ending.code != 3) return "exit code";
  if (std::string broken = broken_message_law(ending); !broken.empty()) return broken;
  for (const auto& file : std::filesystem::directory_iterator(folder.path()))
    if (file.path().filename().string().starts_with(".")) return "left behind: " + file.path().string();
  if (ending.code != 0) return ending.mesh.empty() ? "" : "failed, but wrote a mesh";
  // STL and GLB have 32-bit coordinates only; where these lose detail the program says so.
  if (ending.errors.find(" has 32-bit coordinates: ") != std::string::npos) return "";
  // STL has no vertices: those at one place are the same.
  const bool one_fan = !one.output.ends_with(".stl");
  try {
    return broken_mesh_law(read_written(folder.file(one.output)), one.may_end, one_fan);
  } catch (const std::exception& error) {
    return fmt::format("the mesh cannot be read: {}", error.what());
  }
}

/// The same run by the library, on scalar code, from the parameters in the report.
std::string scalar_mesh(const TemporaryFolder& folder, const DegenerateCase& one) {
  const Context context(2, simd_targets().back());
  const PointCloud cloud = read_points(folder.file(one.input));
  const Reconstruction result = reconstruct(cloud, params_from_json(read_file(folder.file("report.json"))), context);
  WriteOptions options;
  options.ascii = one.ascii;
  const auto& simplify = result.report.simplify;
  options.coordinate_precision = simplify && simplify->triangles < simplify->triangles_before
                                     ? std::numeric_limits<double>::min()
                                     : 1e-3 * result.report.grid.voxel;
  write_mesh(folder.file("again-" + one.output), result.mesh, options, context);
  return read_file(folder.file("again-" + one.output));
}

/// The exit code, after all laws were tried.
int try_case(const DegenerateCase& one) {
  const TemporaryFolder folder;
  std::ofstream(folder.file(one.input), std::ios::binary) << one.bytes;
  const bool report = one.number % 8 == 0;
  const Ending ending = run_program(folder, one, 1, report);
  std::string broken = broken_law(folder, one, ending);
  if (broken.empty() && one.number % 4 == 0) {
    const Ending again = run_program(folder, one, 2, report);
    if (again.code != ending.code || again.errors != ending.errors || again.mesh != ending.mesh)
      broken = fmt::format("two threads give something else: code {}, {}", again.code, again.errors);
  }
  if (broken.empty() && report && ending.code == 0 && scalar_mesh(folder, one) != ending.mesh)
    broken = "scalar code gives another mesh";
  if (!broken.empty()) {
    const auto kept = std::filesystem::temp_directory_path() / fmt::format("soapfilm-case-{}", one.number);
    std::filesystem::copy(folder.path(), kept,
                          std::filesystem::copy_options::recursive | std::filesystem::copy_options::overwrite_existing);
    ADD_FAILURE() << broken << "\nexit code " << ending.code << ", SOAPFILM_CASE=" << one.number << ", files kept in "
                  << kept << "\n"
                  << running << ending.errors;
  }
  return ending.code;
}

size_t cases() {
  const char* full = std::getenv("SOAPFILM_FULL");
  return full != nullptr && std::string(full) == "1" ? 100000 : sanitized ? 1000 : 2000;
}

class Degenerate : public testing::TestWithParam<size_t> {};
constexpr size_t parts = 8;

TEST_P(Degenerate, CloudsGiveASoundMeshOrOneLine) {
  if (const char* chosen = std::getenv("SOAPFILM_CASE")) {
    if (GetParam() != 0) GTEST_SKIP();
    try_case(degenerate_case(std::strtoull(chosen, nullptr, 10)));
    std::printf("%s", running.c_str());
    return;
  }
  std::map<int, size_t> codes;
  for (size_t k = GetParam(); k < cases() && !HasFailure(); k += parts) ++codes[try_case(degenerate_case(k))];
  // Else the cases would not be worth their time.
  const size_t tried = cases() / parts;
  EXPECT_GT(codes[0], tried / 8);
  EXPECT_GT(codes[2], tried / 50);
  EXPECT_GT(codes[3], 0u);
}

INSTANTIATE_TEST_SUITE_P(Cases, Degenerate, testing::Range(size_t{0}, parts));

}  // namespace TEST_FILE
}  // namespace soapfilm
