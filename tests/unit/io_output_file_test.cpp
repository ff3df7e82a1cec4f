// OutputFile: under the user's name there is the old file or the whole new one, never anything between.
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/io/output_file.h"
#include "support/mesh_bytes.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;
using test::contains;

class OutputFileTest : public ::testing::Test {
 protected:
  OutputFileTest() {
    std::string path = (fs::temp_directory_path() / "burnish_output_XXXXXX").string();
    folder_ = ::mkdtemp(path.data());
  }
  ~OutputFileTest() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return folder_ / name; }
  static void put(int fd, const std::string& text) {
    ASSERT_EQ(::write(fd, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  void create(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
  std::string content(const std::string& name) const {
    std::ifstream in(path(name));
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::ptrdiff_t file_count() const { return std::distance(fs::directory_iterator(folder_), {}); }
  mode_t mode(const std::string& name) const {
    struct stat status {};
    ::stat(path(name).c_str(), &status);
    return status.st_mode & 0777;
  }
  static std::string error_of(const std::string& destination, bool overwrite) {
    try {
      const OutputFile file(destination, overwrite);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::unwritable_output);
      return std::string(error.what()) + " | " + error.hint();
    }
    return {};
  }

  fs::path folder_;
};

TEST_F(OutputFileTest, CommitPutsTheWholeFileInPlace) {
  OutputFile file(path("a.stl"), false);
  put(file.fd(), "rubbish that is longer");
  file.truncate();
  put(file.fd(), "content");
  EXPECT_FALSE(fs::exists(path("a.stl")));
  EXPECT_EQ(fs::path(file.temporary_path()).parent_path(), folder_);
  file.commit();
  EXPECT_EQ(content("a.stl"), "content");
  EXPECT_EQ(file_count(), 1);
}

TEST_F(OutputFileTest, WithoutCommitNothingIsLeft) {
  create("a.stl", "old");
  {
    OutputFile file(path("a.stl"), true);
    put(file.fd(), "half");
    EXPECT_EQ(content("a.stl"), "old");
  }
  EXPECT_EQ(content("a.stl"), "old");
  EXPECT_EQ(file_count(), 1);
}

TEST_F(OutputFileTest, AnExistingFileNeedsOverwrite) {
  create("a.stl", "old");
  EXPECT_TRUE(contains(error_of(path("a.stl"), false), {"exists already", "--overwrite"}));
  OutputFile file(path("a.stl"), true);
  put(file.fd(), "new");
  file.commit();
  EXPECT_EQ(content("a.stl"), "new");
}

TEST_F(OutputFileTest, AFileThatAppearedMeanwhileIsNotReplaced) {
  OutputFile file(path("a.stl"), false);
  create("a.stl", "someone else's");
  EXPECT_THROW(file.commit(), Error);
  EXPECT_EQ(content("a.stl"), "someone else's");
}

// The last one is refused: a file appeared, or a folder.
TEST_F(OutputFileTest, SeveralAreCommittedAllOrNone) {
  for (const bool overwrite : {false, true}) {
    if (overwrite) create("a", "old");
    OutputFile a(path("a"), overwrite), b(path("b"), overwrite), c(path("c"), overwrite);
    const std::vector<OutputFile*> files{&a, &b, &c};
    for (OutputFile* file : files) put(file->fd(), "new");
    overwrite ? static_cast<void>(fs::create_directory(path("c"))) : create("c", "someone else's");
    EXPECT_THROW(OutputFile::commit(files), Error);
    EXPECT_EQ(fs::exists(path("a")), overwrite);
    EXPECT_EQ(content("a"), overwrite ? "old" : "");
    EXPECT_FALSE(fs::exists(path("b")));
    if (!overwrite) {
      EXPECT_EQ(content("c"), "someone else's");
    }
    fs::remove(path("c"));
    OutputFile::commit(files);
    for (const char* name : {"a", "b", "c"}) EXPECT_EQ(content(name), "new");
    EXPECT_EQ(file_count(), 3);
    for (const char* name : {"a", "b", "c"}) fs::remove(path(name));
  }
  EXPECT_EQ(file_count(), 0);
}

TEST_F(OutputFileTest, PermissionsAreThoseOfANewFileOrOfTheReplacedOne) {
  const mode_t before = ::umask(027);
  {
    OutputFile file(path("a.stl"), false);
    file.commit();
  }
  ::umask(before);
  EXPECT_EQ(mode("a.stl"), 0640u);
  ::chmod(path("a.stl").c_str(), 0604);
  OutputFile file(path("a.stl"), true);
  file.commit();
  EXPECT_EQ(mode("a.stl"), 0604u);
}

TEST_F(OutputFileTest, DestinationsThatCannotBe) {
  EXPECT_TRUE(contains(error_of(path("no/a.stl"), false), {"No such file or directory"}));
  EXPECT_TRUE(contains(error_of(folder_.string(), true), {"is a folder"}));
  EXPECT_TRUE(contains(error_of(path("new/"), true), {"is a folder"}));
  EXPECT_TRUE(contains(error_of("/dev/null", true), {"is not a regular file"}));
  EXPECT_FALSE(error_of("", true).empty());
  ::chmod(folder_.c_str(), 0500);
  if (::geteuid() != 0) {  // root may write anywhere
    EXPECT_TRUE(contains(error_of(path("a.stl"), false), {"Permission denied"}));
  }
  ::chmod(folder_.c_str(), 0700);
}

TEST_F(OutputFileTest, LinksStayAndTheirFilesAreReplaced) {
  create("real.stl", "old");
  fs::create_symlink("real.stl", path("link.stl"));
  EXPECT_TRUE(contains(error_of(path("link.stl"), false), {"exists already"}));
  OutputFile file(path("link.stl"), true);
  put(file.fd(), "new");
  file.commit();
  EXPECT_TRUE(fs::is_symlink(path("link.stl")));
  EXPECT_EQ(content("real.stl"), "new");
}

TEST_F(OutputFileTest, LongNamesHaveTemporariesToo) {
  OutputFile file(path(std::string(251, 'n') + ".stl"), false);
  file.commit();
  EXPECT_EQ(file_count(), 1);
}

TEST_F(OutputFileTest, RemoveAllTemporariesRemovesThoseOfLivingFilesOnly) {
  {
    OutputFile done(path("done.stl"), false);
    done.commit();
    std::vector<std::unique_ptr<OutputFile>> files;
    for (int i = 0; i < 70; ++i)  // more than there are slots
      files.push_back(std::make_unique<OutputFile>(path(std::to_string(i)), false));
    EXPECT_EQ(file_count(), 71);
    OutputFile::remove_all_temporaries();
    EXPECT_EQ(file_count(), 7);
  }
  EXPECT_EQ(file_count(), 1);
}

}  // namespace
}  // namespace burnish
