// How often a test repeats itself with other random numbers. Under sanitizers, which make it ten times as slow, less often: what they look for, memory and
// threads, is met the first time, and numbers are judged by the builds without them.
#pragma once

#include <cstdint>

namespace burnish::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kIsSanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
inline constexpr bool kIsSanitized = true;
#else
inline constexpr bool kIsSanitized = false;
#endif
#else
inline constexpr bool kIsSanitized = false;
#endif

constexpr std::uint64_t repetitions(std::uint64_t all, std::uint64_t under_sanitizers) { return kIsSanitized ? under_sanitizers : all; }

}  // namespace burnish::test
