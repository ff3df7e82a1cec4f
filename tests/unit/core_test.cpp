// Lengths, bytes, errors and the loops that must not depend on the number of threads.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "burnish/core/error.h"
#include "burnish/core/length.h"
#include "burnish/core/parallel.h"

namespace burnish {
namespace {

TEST(Length, ReadsTheThreeForms) {
  EXPECT_EQ(parse_length("0.5")->in_model_units(200, 3), 0.5);
  EXPECT_EQ(parse_length("0.5%")->in_model_units(200, 3), 1.0);
  EXPECT_EQ(parse_length("2h")->in_model_units(200, 3), 6.0);
}

TEST(Length, RefusesEverythingElse) {
  for (const char* text : {"", "h", "%", "-1", "1 h", "1hh", "1e999", "nan", "inf", "1,5", "0x1p3q", "-0"})
    EXPECT_FALSE(parse_length(text)) << text;
}

TEST(Bytes, ReadsBinaryMultiples) {
  EXPECT_EQ(parse_bytes("1024"), 1024u);
  EXPECT_EQ(parse_bytes("2G"), 2ull << 30);
  EXPECT_EQ(parse_bytes("1.5k"), 1536u);
  EXPECT_EQ(parse_bytes("3MiB"), 3ull << 20);
  for (const char* text : {"", "0", "G", "1x", "1GG", "-1"}) EXPECT_FALSE(parse_bytes(text)) << text;
}

TEST(Error, ExitCodesAreTheDocumentedOnes) {
  EXPECT_EQ(exit_code(ErrorCode::answer_is_no), 1);
  EXPECT_EQ(exit_code(ErrorCode::usage), 2);
  EXPECT_EQ(exit_code(ErrorCode::unreadable_input), 3);
  EXPECT_EQ(exit_code(ErrorCode::unwritable_output), 4);
  EXPECT_EQ(exit_code(ErrorCode::guarantee_unmet), 5);
  EXPECT_EQ(exit_code(ErrorCode::memory_limit), 6);
  EXPECT_EQ(exit_code(ErrorCode::bug), 70);
  EXPECT_EQ(exit_code(ErrorCode::interrupted), 130);
}

TEST(Parallel, SumsHaveTheSameBitsForAnyNumberOfThreads) {
  std::mt19937_64 random(7);
  std::vector<double> values(100'003);
  for (double& v : values) v = std::ldexp(std::uniform_real_distribution<>(-1, 1)(random), static_cast<int>(random() % 60));
  const auto sum = [&] {
    return parallel_reduce(
        values.size(), 1000, 0.0,
        [&](std::size_t b, std::size_t e) {
          double s = 0;
          for (std::size_t i = b; i < e; ++i) s += values[i];
          return s;
        },
        [](double a, double b) { return a + b; });
  };
  const double reference = [&] { const ThreadLimit one(1); return sum(); }();
  const ThreadLimit four(4);
  for (int run = 0; run < 20; ++run) EXPECT_EQ(sum(), reference);
}

TEST(Parallel, SortSortsAndExceptionsArrive) {
  std::mt19937_64 random(11);
  std::vector<std::uint64_t> values(50'000);
  for (auto& v : values) v = random();
  parallel_sort(values);
  EXPECT_TRUE(std::is_sorted(values.begin(), values.end()));
  EXPECT_THROW(parallel_for(10'000, [](std::size_t i) { if (i == 7777) throw Error(ErrorCode::bug, "x"); }), Error);
}

}  // namespace
}  // namespace burnish
