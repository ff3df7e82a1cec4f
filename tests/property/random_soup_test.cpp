// What the pipeline promises, it promises for any facets at all.
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <vector>

#include "support/folder.h"
#include "support/pipeline_promises.h"
#include "support/repetitions.h"

namespace burnish {
namespace {

using namespace test;

TEST(RandomSoup, IsMadeAValidSolidOrRefused) {
  const Folder folder;
  for (std::uint64_t seed = 1; seed <= repetitions(60, 15); ++seed) {
    std::mt19937_64 engine(seed);
    std::vector<std::uint8_t> bytes(60 + engine() % 120);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(engine() >> 32);
    EXPECT_EQ(broken_promise(small_job(bytes), folder.path("")), "") << "seed " << seed;
  }
}

}  // namespace
}  // namespace burnish
