#include "soapfilm/run/checked_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "support/process.h"

namespace soapfilm {
namespace TEST_FILE {

struct Kept : testing::Test {
  /// Of so many bytes.
  void write(size_t bytes) {
    CheckedFile to(path);
    std::string text(bytes, ' ');
    for (size_t i = 0; i < bytes; ++i) text[i] = static_cast<char>(i % 251);
    for (size_t i = 0; i < bytes; i += 77777) to.stream().write(text.data() + i, std::min<ptrdiff_t>(77777, bytes - i));
    ASSERT_TRUE(to.close());
    ASSERT_EQ(std::filesystem::file_size(path), bytes + 8);
    ASSERT_EQ(test::read_file(path).substr(0, bytes), text);
  }
  void change(size_t at) {
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekg(static_cast<std::streamoff>(at));
    const char was = static_cast<char>(file.get());
    file.seekp(static_cast<std::streamoff>(at));
    file.put(static_cast<char>(was ^ 4));
  }

  test::TemporaryFolder folder;
  const std::string path = folder.file("kept");
};

TEST_F(Kept, IsWholeAsItWasWritten) {
  for (const size_t bytes : {0u, 1u, 8u, 77777u, (1u << 20) - 1, 1u << 20, (1u << 20) + 1, 3u << 20}) {
    write(bytes);
    EXPECT_TRUE(is_whole(path, Context(1))) << bytes;
  }
}

TEST_F(Kept, IsNotWholeWhereBytesAreLostOrChanged) {
  constexpr size_t bytes = (2u << 20) + 5;
  for (const size_t at : {size_t{0}, bytes / 2, bytes - 1, bytes, bytes + 7}) {
    write(bytes);
    change(at);
    EXPECT_FALSE(is_whole(path, Context(1))) << at;
  }
  for (const size_t left : {size_t{0}, size_t{7}, size_t{1} << 20, bytes, bytes + 7}) {
    write(bytes);
    std::filesystem::resize_file(path, left);
    EXPECT_FALSE(is_whole(path, Context(1))) << left;
  }
  write(bytes);  // lost while it was written: the system puts zeros there
  std::fstream(path, std::ios::binary | std::ios::in | std::ios::out).write(std::string(4096, '\0').data(), 4096);
  EXPECT_FALSE(is_whole(path, Context(1)));
  EXPECT_FALSE(is_whole(folder.file("absent"), Context(1)));
}

TEST_F(Kept, SaysWhereNothingCanBeWritten) {
  CheckedFile to(folder.file("absent") + "/kept");
  to.stream() << "text";
  EXPECT_FALSE(to.close());
}

}  // namespace TEST_FILE
}  // namespace soapfilm
