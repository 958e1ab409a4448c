// Files whose first name is another one.
#include "soapfilm/platform/new_file.h"

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

namespace soapfilm {

int open_unnamed_file(const std::string&, unsigned) {
  errno = EOPNOTSUPP;
  return -1;
}

std::string name_for_others(int) { return {}; }

int name_file(int, const std::string&) { return EOPNOTSUPP; }

int store_file(int) { return 0; }

NewFile::NewFile(std::string name) : name_(std::move(name)), path_(name_ + "-part") {}

NewFile::~NewFile() {
  std::error_code ignored;
  if (!path_.empty()) std::filesystem::remove(path_, ignored);
}

bool NewFile::complete() {
  std::error_code error;
  std::filesystem::rename(path_, name_, error);
  if (!error) path_.clear();
  return !error;
}

}  // namespace soapfilm
