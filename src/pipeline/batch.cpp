#include "burnish/pipeline/batch.h"

#include <algorithm>
#include <array>
#include <utility>

#include "json.h"

namespace burnish {
namespace {

constexpr std::array kCodes{ErrorCode::answer_is_no, ErrorCode::usage,      ErrorCode::unreadable_input, ErrorCode::unwritable_output, ErrorCode::guarantee_unmet,
                            ErrorCode::memory_limit, ErrorCode::time_limit, ErrorCode::bug,              ErrorCode::interrupted};

template <class T>
std::optional<T> value_at(const Json& json, const std::string& pointer) {
  const Json::json_pointer at(pointer);
  if (!json.contains(at) || !json.at(at).is_number()) return std::nullopt;
  return json.at(at).get<T>();
}

std::optional<Error> failure_in(const Json& told) {
  const Json& error = told.contains("error") ? told["error"] : told.contains("failure") ? told["failure"] : Json();
  if (!error.is_object()) return std::nullopt;
  const int number = error["exit_code"];
  const auto code = std::find_if(kCodes.begin(), kCodes.end(), [&](ErrorCode c) { return exit_code(c) == number; });
  return Error(code == kCodes.end() ? ErrorCode::bug : *code, error["message"], error["hint"]);
}

std::string verdict_of_failure(ErrorCode code) {
  switch (code) {
    case ErrorCode::unreadable_input: return "unreadable";
    case ErrorCode::unwritable_output: return "unwritable";
    case ErrorCode::guarantee_unmet: return "not written";
    case ErrorCode::memory_limit: return "memory";
    case ErrorCode::time_limit: return "time limit";
    case ErrorCode::interrupted: return "interrupted";
    case ErrorCode::answer_is_no:
    case ErrorCode::usage: return "refused";
    case ErrorCode::bug: break;
  }
  return "crashed";
}

void read_check(const Json& told, BatchFile& file) {
  file.facets = value_at<std::uint64_t>(told, "/defects/facets");
  file.open_edges = value_at<std::uint64_t>(told, "/defects/open_edges");
  file.self_intersections = value_at<std::uint64_t>(told, "/defects/self_intersecting_pairs");
  file.volume = value_at<double>(told, "/defects/volume");
  file.verdict = file.exit_code == 0 ? "valid" : "not valid";
}

void read_report(const Json& told, BatchFile& file) {
  file.facets = value_at<std::uint64_t>(told, "/after/facets");
  file.open_edges = value_at<std::uint64_t>(told, "/before/open_edges");
  file.self_intersections = value_at<std::uint64_t>(told, "/before/self_intersecting_pairs");
  file.volume = value_at<double>(told, "/after/volume");
  for (const char* way : {"/deviation/input_to_output/max", "/deviation/output_to_input/max"})
    if (const auto d = value_at<double>(told, way)) file.max_deviation = std::max(*d, file.max_deviation.value_or(0));
  const Json& output = told["output"];
  if (output["written"] == true) file.verdict = output["verified"] != true ? "not verified" : output["is_sheet"] == true ? "sheet" : "valid";
}

Json json_of(const BatchFile& f, bool with_results) {
  Json json = {
      {"input", f.input},
      {"output", f.output.empty() ? Json() : Json(f.output)},
      {"exit_code", f.exit_code},
      {"verdict", f.verdict},
      {"facets", or_null(f.facets)},
      {"open_edges_before", or_null(f.open_edges)},
      {"self_intersections_before", or_null(f.self_intersections)},
      {"volume", or_null(f.volume)},
      {"max_deviation", or_null(f.max_deviation)},
      {"units", json_of(f.unit)},
      {"seconds", f.seconds},
      {"failure", failure_of(f.failure)},
  };
  if (!with_results) return json;
  Json told = Json::parse(f.told, nullptr, false);
  json["result"] = told.is_discarded() || told.contains("error") ? Json() : std::move(told);
  return json;
}

}  // namespace

int BatchResult::exit_code() const {
  int highest = 0;
  for (const BatchFile& file : files) highest = std::max(highest, file.exit_code);
  return highest;
}

void read_told(BatchFile& file) {
  const Json told = Json::parse(file.told, nullptr, false);
  if (!told.is_object()) {
    file.verdict = verdict_of_failure(ErrorCode::bug);
    return;
  }
  if (const auto unit = told.find("units"); unit != told.end() && unit->is_string()) file.unit = model_unit(unit->get<std::string>());
  if (told.contains("defects"))
    read_check(told, file);
  else if (told.contains("output"))
    read_report(told, file);
  file.failure = failure_in(told);
  if (file.verdict.empty()) file.verdict = file.failure ? verdict_of_failure(file.failure->code()) : "not written";
}

std::string to_json(const BatchResult& batch, bool with_results) {
  Json files = Json::array();
  for (const BatchFile& file : batch.files) files.push_back(json_of(file, with_results));
  return text_of({
      {"version", kReportVersion},
      {"generator", generator()},
      {"command", batch.command},
      {"units", json_of(batch.unit)},
      {"jobs", batch.jobs},
      {"exit_code", batch.exit_code()},
      {"seconds", batch.seconds},
      {"files", std::move(files)},
  });
}

}  // namespace burnish
