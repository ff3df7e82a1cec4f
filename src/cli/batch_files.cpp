#include "batch_files.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <system_error>
#include <utility>

#include "burnish/core/error.h"
#include "commands.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kHole = "{}";

[[noreturn]] void refuse(const std::string& message, const std::string& hint) { throw Error(ErrorCode::usage, message, hint); }

// Every {} is replaced; what a name brings with it is none.
std::string filled(std::string_view pattern, const std::string& stem) {
  std::string text;
  for (std::size_t hole; (hole = pattern.find(kHole)) != pattern.npos; pattern.remove_prefix(hole + kHole.size())) text.append(pattern.substr(0, hole)).append(stem);
  return text.append(pattern);
}

void require_place(const PlacedOption& option) {
  const std::string& given = *option.path;
  if (is_place(given)) return;
  const std::string suffix(option.suffix.empty() ? fs::path(given).extension().string() : std::string(option.suffix));
  refuse(fmt::format("{} {}: one file for several inputs", option.option, given),
         fmt::format("name a folder with a slash behind it, such as {0} out/, or a pattern: {0} 'out/{{}}{1}'", option.option, suffix));
}

// Which files there are, and what stands behind each: "the input a.stl", "-o for a.stl".
class Claims {
 public:
  void claim_input(const std::string& input) { claims_.emplace(resolved_path(input), Claim{input, {}}); }

  void claim(const std::string& file, std::string_view option, const std::string& input) {
    const auto [at, is_new] = claims_.emplace(resolved_path(file), Claim{input, option});
    if (is_new) return;
    const Claim& other = at->second;
    if (other.option.empty()) refuse(fmt::format("{}: {} names an input", file, option), "write to another folder, or give a pattern such as 'out/{}-clean.stl'");
    refuse(other.option == option ? fmt::format("{}: {} would write {} and {} to the same file", file, option, other.input, input)
                                  : fmt::format("{}: {} and {} name the same file", file, other.option, option),
           other.option == option ? "do it in two runs with two folders, or rename one of the inputs" : "give one of them another folder");
  }

 private:
  struct Claim {
    std::string input;
    std::string_view option;  // empty: it is an input
  };
  std::map<std::string, Claim> claims_;
};

}  // namespace

bool is_place(const std::string& given) {
  std::error_code ignored;
  return given.ends_with('/') || given.find(kHole) != given.npos || fs::is_directory(given, ignored);
}

std::string file_for(const std::string& given, const std::string& input, std::string_view suffix) {
  if (given.empty() || !is_place(given)) return given;
  if (input == "-") refuse(fmt::format("{}: standard input has no name that a file could get", given), "name the file, such as -o out.stl");
  const fs::path name = fs::path(input).filename();
  if (given.find(kHole) != given.npos) return filled(given, name.stem().string());
  return (fs::path(given) / (suffix.empty() ? name.string() : name.stem().string() + std::string(suffix))).string();
}

std::string file_for_all(const std::string& given, const std::string& name) {
  if (given.empty()) return {};
  const std::size_t hole = given.find(kHole);
  return ((hole == given.npos ? fs::path(given) / "" : fs::path(given.substr(0, hole)).parent_path()) / name).string();
}

PlacedFiles::PlacedFiles(const std::vector<std::string>& inputs, std::vector<PlacedOption> options, const std::vector<OtherFile>& others)
    : options_(std::move(options)), files_(options_.size()) {
  const bool several = inputs.size() > 1;
  Claims claims;
  for (const std::string& input : inputs) claims.claim_input(input);
  for (std::size_t o = 0; o < options_.size(); ++o) {
    const PlacedOption& option = options_[o];
    is_place_.push_back(is_place(*option.path));
    if (option.path->empty()) continue;
    if (several) require_place(option);
    for (const std::string& input : inputs) {
      files_[o].push_back(file_for(*option.path, input, option.suffix));
      if (several) claims.claim(files_[o].back(), option.option, input);
    }
  }
  for (const OtherFile& other : others) claims.claim(other.file, other.option, other.content);
}

void PlacedFiles::take(std::size_t input) const {
  for (std::size_t o = 0; o < options_.size(); ++o)
    if (!files_[o].empty()) *options_[o].path = files_[o][input];
}

void PlacedFiles::make_folders() {
  for (std::size_t o = 0; o < options_.size(); ++o)
    if (is_place_[o])
      for (const std::string& file : files_[o]) folders_.make_for(file);
}

}  // namespace burnish
