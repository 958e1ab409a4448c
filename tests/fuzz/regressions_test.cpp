// Inputs that once broke something (fuzz/regressions/FORMAT/NAME), read again in every build.
#include <filesystem>
#include <functional>

#include "../io/files.h"
#include "../io/samples.h"
#include "soapfilm/error.h"
#include "soapfilm/io/formats.h"
#include "soapfilm/params.h"
#include "support/laws_of_files.h"
#include "support/process.h"

namespace soapfilm {
namespace TEST_FILE {

/// Calls `read`, which may refuse with one line.
void read_or_refuse(const std::function<void()>& read) {
  std::string message;
  try {
    read();
  } catch (const InputError& error) {
    message = error.what();
  } catch (const MemoryError& error) {
    message = error.what();
  } catch (const ParameterError& error) {
    message = error.what();
  }
  EXPECT_EQ(message.find_first_of("\r\n"), std::string::npos) << message;
}

void read_again(const std::string& path, const std::string& bytes) {
  read_or_refuse([&] {
    io::ByteSource source(path, bytes);
    ReadReport report;
    EXPECT_EQ(test::broken_law(read_points(source, report, {}, Context(1))), "");
  });
  read_or_refuse([&] {
    io::ByteSource source(path, bytes);
    ReadReport report;
    EXPECT_EQ(test::broken_law(read_mesh(source, report)), "");
  });
}

TEST(Regressions, AreReadOrRefused) {
  const TemporaryFolder folder;  // with the files that sets of scans name
  write_points(folder / "a.ply", rich_cloud(1, 3, 3, 4));
  folder.write("b.xyz", "1 2 3\n");
  size_t count = 0;
  for (const auto& file : std::filesystem::recursive_directory_iterator(SOAPFILM_REGRESSIONS)) {
    if (!file.is_regular_file()) continue;
    const std::string format = file.path().parent_path().filename().string();
    const std::string bytes = test::read_file(file.path());
    SCOPED_TRACE(file.path().string());
    if (format == "params")
      read_or_refuse([&] { to_json(params_from_json(bytes)); });
    else if (format.starts_with("."))
      read_again(folder / "fuzzed" + format, bytes);
    ++count;
  }
  EXPECT_GT(count, 0u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
