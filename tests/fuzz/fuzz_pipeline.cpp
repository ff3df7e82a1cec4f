// Any bytes, made a tiny model and options, through the whole pipeline from file to file: a valid solid comes out, or a reason
// and no file. Anything else is a bug.
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "burnish/core/parallel.h"
#include "support/pipeline_promises.h"

namespace {

// In memory where there is such a place: thousands of runs write little files.
class RunFolder {
 public:
  RunFolder() {
    const std::filesystem::path shared = "/dev/shm";
    const bool is_there = ::access(shared.c_str(), W_OK) == 0;
    std::string path = (is_there ? shared : std::filesystem::temp_directory_path()) / "burnish_fuzz_XXXXXX";
    if (::mkdtemp(path.data()) == nullptr) std::abort();
    path_ = path;
  }
  ~RunFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const RunFolder folder;
  const burnish::ThreadLimit one(1);  // the same result, without the cost of waking threads for a handful of blocks
  const std::string broken = burnish::test::broken_promise(burnish::test::small_job({data, data + size}), folder.path());
  if (broken.empty()) return 0;
  std::fprintf(stderr, "broken promise: %s\n", broken.c_str());
  std::abort();
}
