#include "cli/browser.h"

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string_view>

#if __has_include(<spawn.h>)
#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>
extern char** environ;
#endif

namespace soapfilm::cli {

#if __has_include(<spawn.h>)

namespace {

#ifdef __APPLE__
constexpr const char* opener = "open";
bool has_desktop() { return true; }
#else
constexpr const char* opener = "xdg-open";
bool is_set(const char* variable) {
  const char* value = std::getenv(variable);
  return value && *value;
}
bool has_desktop() { return is_set("DISPLAY") || is_set("WAYLAND_DISPLAY"); }
#endif

bool is_program(const char* name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((std::filesystem::path(folder) / name).c_str(), X_OK) == 0) return true;
  return false;
}

}  // namespace

bool open_in_browser(const std::string& path) {
  if (!has_desktop() || !is_program(opener)) return false;
  // Without a shell, so that no name of a file can be a command; its messages would only disturb ours.
  std::string name = opener;
  std::string file = std::filesystem::absolute(path).string();
  char* arguments[] = {name.data(), file.data(), nullptr};
  posix_spawn_file_actions_t actions;
  if (posix_spawn_file_actions_init(&actions) != 0) return false;
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int error = posix_spawnp(&child, opener, &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  return error == 0;
}

#else

bool open_in_browser(const std::string& /*path*/) { return false; }

#endif

}  // namespace soapfilm::cli
