// Completion as real shells do it, and manual pages.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "support/program.h"

namespace soapfilm::test {
namespace TEST_FILE {

const std::vector<std::string> commands = {"reconstruct", "scan", "evaluate", "compare", "measure", "simplify",
                                           "remesh",      "info", "render",   "view",    "tiles"};

/// The long options that a help page lists.
std::set<std::string> options_of_help(const std::string& page) {
  std::set<std::string> names;
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line);) {
    const size_t first = line.find_first_not_of(' ');
    if (first != 2 || line[first] != '-') continue;
    const size_t name = line.find("--");
    names.insert(line.substr(name, line.find_first_of(" ,\n", name) - name));
  }
  return names;
}

std::set<std::string> lines_of(const std::string& text) {
  std::set<std::string> all;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (!line.empty()) all.insert(line);
  return all;
}

class BashCompletion : public testing::Test {
 protected:
  void SetUp() override { std::ofstream(script) << run({"completion", "bash"}).out; }

  /// What bash offers for the last word of a command line; "<files>" where it completes names of files instead.
  std::set<std::string> offers(const std::vector<std::string>& words) const {
    const std::string line = fmt::format(
        "compopt() {{ for o; do case $o in dirnames) echo '<folders>' ;; default) [[ $before == +o ]] && files= ;; "
        "esac; "
        "before=$o; done; }}\nfiles='<files>'\nsource {}\nCOMP_WORDS=({}) COMP_CWORD={}\n_soapfilm\n"
        "printf '%s\\n' \"${{COMPREPLY[@]}}\"\n[[ ${{#COMPREPLY[@]}} == 0 ]] && echo \"$files\"\nexit 0\n",
        script, fmt::join(words, " "), words.size() - 1);
    const ProcessResult result = run_process({"/bin/bash", "--norc", "-c", line});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.err, "");
    return lines_of(result.out);
  }

  TemporaryFolder folder;
  std::string script = folder.file("completion.bash");
};

using Words = std::set<std::string>;

TEST_F(BashCompletion, OffersCommandsFirst) {
  EXPECT_EQ(offers({"soapfilm", "''"}), Words(commands.begin(), commands.end()));
  EXPECT_EQ(offers({"soapfilm", "re"}), (Words{"reconstruct", "remesh", "render"}));
  EXPECT_EQ(offers({"soapfilm", "--threads", "2", "sc"}), Words{"scan"});
}

TEST_F(BashCompletion, OffersEveryOptionOfTheHelpPage) {
  for (const std::string& command : commands) {
    Words offered = offers({"soapfilm", command, "--"});
    Words expected = options_of_help(run({command, "--help"}).out);
    for (const std::string& global : options_of_help(run({"--help"}).out)) expected.insert(global);
    EXPECT_EQ(offered, expected) << command;
  }
}

TEST_F(BashCompletion, OffersTheValuesOfAnEnumeration) {
  EXPECT_EQ(offers({"soapfilm", "reconstruct", "a.ply", "--method", "graph"}), (Words{"graph-cut-26", "graph-cut-6"}));
  EXPECT_EQ(offers({"soapfilm", "reconstruct", "--settle", "''"}), (Words{"off", "on"}));
  EXPECT_EQ(offers({"soapfilm", "reconstruct", "--method", "=", "vr"}), Words{"vrip"}) << "--method=vr";
  EXPECT_EQ(offers({"soapfilm", "reconstruct", "--settle", "="}), (Words{"off", "on"})) << "--settle=";
  EXPECT_EQ(offers({"soapfilm", "render", "--framing", "f"}), Words{"fitted"});
  EXPECT_EQ(offers({"soapfilm", "evaluate", "a.ply", "--truth", "kn"}), Words{"knot"});
  EXPECT_EQ(offers({"soapfilm", "scan", "tor"}), Words{"torus"});
}

TEST_F(BashCompletion, LeavesFilesAndFoldersToBash) {
  EXPECT_EQ(offers({"soapfilm", "reconstruct", "bun"}), Words{"<files>"});
  EXPECT_EQ(offers({"soapfilm", "reconstruct", "a.ply", "-o", "b"}), Words{"<files>"});
  EXPECT_EQ(offers({"soapfilm", "scan", "knot.ply"}), Words{"<files>"}) << "a mesh";
  EXPECT_EQ(offers({"soapfilm", "scan", "knot", "-o", "d"}), Words{"<folders>"});
  EXPECT_EQ(offers({"soapfilm", "reconstruct", "--voxel", "1"}), Words{}) << "a number";
}

/// A shell at a terminal, which types `keys` and ends the shell; what appears on the screen.
std::string typed(const std::vector<std::string>& shell, const std::string& keys, const std::string& folder) {
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child == 0) {
    if (chdir(folder.c_str()) != 0) _exit(126);
    setenv("TERM", "dumb", 1);
    std::vector<char*> arguments;
    for (const std::string& argument : shell) arguments.push_back(const_cast<char*>(argument.c_str()));
    arguments.push_back(nullptr);
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  EXPECT_EQ(write(terminal, keys.data(), keys.size()), static_cast<ssize_t>(keys.size()));
  std::string screen;
  char buffer[4096];
  for (ssize_t n; (n = read(terminal, buffer, sizeof buffer)) > 0;) screen.append(buffer, static_cast<size_t>(n));
  int status = 0;
  waitpid(child, &status, 0);
  close(terminal);
  return screen;
}

TEST_F(BashCompletion, WorksAtATerminal) {
  std::ofstream(folder.file("a scan.ply")) << "ply\n";
  const std::string screen = typed({"/bin/bash", "--norc", "--noprofile", "-i"},
                                   "bind 'set bell-style none'; source completion.bash; soapfilm() { echo \"<$*>\"; }\n"
                                   "soapfilm reco\ta\t--meth\tvr\t\nexit\n",
                                   folder.path());
  EXPECT_TRUE(contains(screen, "<reconstruct a scan.ply --method vrip>")) << screen;
}

TEST(FishCompletion, OffersWhatBashDoes) {
  const std::string fish = "/usr/bin/fish";
  if (!std::filesystem::exists(fish)) GTEST_SKIP() << "fish is not installed";
  const TemporaryFolder folder;
  std::ofstream(folder.file("soapfilm.fish")) << run({"completion", "fish"}).out;
  std::ofstream(folder.file("a.ply")) << "ply\n";
  const auto offers = [&](const std::string& line) {
    const ProcessResult result =
        run_process({fish, "--no-config", "-c",
                     "cd " + folder.path().string() + "; source soapfilm.fish; complete --do-complete '" + line + "'"});
    EXPECT_EQ(result.err, "");
    Words words;
    for (const std::string& one : lines_of(result.out)) words.insert(one.substr(0, one.find('\t')));
    return words;
  };
  EXPECT_EQ(offers("soapfilm re"), (Words{"reconstruct", "remesh", "render"}));
  EXPECT_EQ(offers("soapfilm reconstruct a.ply --method graph"), (Words{"graph-cut-26", "graph-cut-6"}));
  EXPECT_EQ(offers("soapfilm scan tor"), Words{"torus"});
  EXPECT_EQ(offers("soapfilm reconstruct a"), Words{"a.ply"});
  for (const std::string& command : commands) {
    Words expected = options_of_help(run({command, "--help"}).out), offered;
    for (const std::string& one : offers("soapfilm " + command + " --"))
      if (one.rfind("--", 0) == 0) offered.insert(one);
    for (const std::string& one : expected) EXPECT_TRUE(offered.count(one)) << command << " " << one;
  }
}

TEST(ZshCompletion, WorksAtATerminal) {
  const std::string zsh = "/usr/bin/zsh";
  if (!std::filesystem::exists(zsh)) GTEST_SKIP() << "zsh is not installed";
  const TemporaryFolder folder;
  std::ofstream(folder.file("_soapfilm")) << run({"completion", "zsh"}).out;
  std::ofstream(folder.file("a.ply")) << "ply\n";
  const std::string screen =
      typed({zsh, "-f", "-i"},
            "fpath=($PWD $fpath); autoload -U compinit; compinit -u -d dump; soapfilm() { echo \"<$*>\" }\n"
            "soapfilm reco\ta.p\t--meth\tvr\t\nsoapfilm scan tor\t--orb\tri\t\nexit\n",
            folder.path());
  EXPECT_TRUE(contains(screen, "<reconstruct a.ply --method=vrip>")) << screen;
  EXPECT_TRUE(contains(screen, "<scan torus --orbit=ring>")) << screen;
}

TEST(ManualPages, HaveEveryOptionOfTheHelpPages) {
  for (const std::string& command : commands) {
    std::string page = run({"man", command}).out;
    page.erase(std::remove(page.begin(), page.end(), '\\'), page.end());
    for (const std::string& option : options_of_help(run({command, "--help"}).out))
      EXPECT_TRUE(option == "--help" || contains(page, "fB" + option + "fR")) << command << " " << option;
  }
  const std::string page = run({"man"}).out;
  for (const std::string& command : commands) EXPECT_TRUE(contains(page, "soapfilm\\-" + command)) << command;
  EXPECT_TRUE(contains(page, ".SH EXIT CODES")) << page;
}

TEST(ManualPages, AreGoodRoff) {
  const TemporaryFolder folder;
  for (std::string command : {"", "reconstruct", "scan", "evaluate", "simplify", "remesh", "info", "render", "view"}) {
    const std::string file = folder.file("page.1");
    std::ofstream(file)
        << run(command.empty() ? std::vector<std::string>{"man"} : std::vector{std::string("man"), command}).out;
    if (std::filesystem::exists("/usr/bin/groff")) {
      const ProcessResult groff = run_process({"/usr/bin/groff", "-man", "-Tascii", "-ww", "-z", file});
      EXPECT_EQ(groff.exit_code, 0);
      EXPECT_EQ(groff.err, "") << command;
    }
    if (std::filesystem::exists("/usr/bin/mandoc")) {
      const ProcessResult lint = run_process({"/usr/bin/mandoc", "-T", "lint", "-W", "warning", file});
      EXPECT_EQ(lint.out + lint.err, "") << command;
    }
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
