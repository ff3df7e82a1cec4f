#include "batch_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "burnish/core/timer.h"
#include "burnish/pipeline/batch.h"
#include "report_error.h"
#include "report_file.h"
#include "streams.h"
#include "values.h"

namespace burnish {
namespace {

constexpr std::size_t kLeastNameWidth = 12, kMostNameWidth = 40;

std::string or_dash(const auto& value, std::string_view format) { return value ? fmt::format(fmt::runtime(format), *value) : std::string("-"); }

std::size_t name_width(const std::vector<BatchFile>& files) {
  std::size_t width = kLeastNameWidth;
  for (const BatchFile& file : files) width = std::max(width, file.input.size());
  return std::min(width, kMostNameWidth);
}

// The end of a name says more than its beginning.
std::string fitted(const std::string& name, std::size_t width) {
  return name.size() <= width ? name : "..." + name.substr(name.size() - (width - 3));
}

// Columns of the table that have a unit: in their heads, unless files differ in it.
struct Columns {
  explicit Columns(const BatchResult& batch) : is_check(batch.command == "check"), name(name_width(batch.files)), unit(batch.unit) {
    const BatchFile* first = nullptr;
    for (const BatchFile& file : batch.files) {
      if (!file.volume) continue;  // no figure that has one
      if (first == nullptr) first = &file;
      mixed |= file.unit != first->unit;
    }
    if (first != nullptr) unit = mixed ? std::nullopt : first->unit;
    if (mixed) volume += 5, deviation += 3;
  }
  bool is_check, mixed = false;
  std::size_t name;
  std::optional<ModelUnit> unit;  // of the heads
  int volume = 13, deviation = 11;
};

std::string line_of(const BatchFile& f, const Columns& columns) {
  const auto cell = [&](const std::optional<double>& value, std::string_view format, int power) {
    return or_dash(value, format) + (value && columns.mixed ? unit_suffix(f.unit, power) : std::string());
  };
  std::string text = fmt::format("{:<{}}  {:<12}{:>10}{:>8}{:>10}{:>{}}", fitted(f.input, columns.name), columns.name, f.verdict, or_dash(f.facets, "{}"), or_dash(f.open_edges, "{}"),
                                 or_dash(f.self_intersections, "{}"), cell(f.volume, "{:.6g}", 3), columns.volume);
  if (!columns.is_check) text += fmt::format("{:>{}}", cell(f.max_deviation, "{:.3g}", 1), columns.deviation);
  return text + fmt::format("{:>8.1f}\n", f.seconds);
}

std::string table_of(const BatchResult& batch) {
  const Columns columns(batch);
  std::string text = fmt::format("{:<{}}  {:<12}{:>10}{:>8}{:>10}{:>{}}", "file", columns.name, "verdict", "facets", "open", "crossing",
                                 fmt::format("volume{}", unit_suffix(columns.unit, 3)), columns.volume);
  if (!columns.is_check) text += fmt::format("{:>{}}", fmt::format("off by{}", unit_suffix(columns.unit)), columns.deviation);
  text += fmt::format("{:>8}\n", "s");
  for (const BatchFile& file : batch.files) text += line_of(file, columns);
  return text;
}

// What went wrong, and how many did not.
std::string closing_of(const BatchResult& batch) {
  std::string text;
  for (const BatchFile& file : batch.files)
    if (file.failure) text += fmt::format("{}: exit code {}: {}\n", file.input, file.exit_code, file.failure->what());
  const auto well = std::count_if(batch.files.begin(), batch.files.end(), [](const BatchFile& f) { return f.exit_code == 0; });
  return text + fmt::format("{} of {} {} ({:.1f} s)\n", well, batch.files.size(), batch.command == "check" ? "are valid solids" : "done and verified", batch.seconds);
}

class Batch {
 public:
  explicit Batch(const BatchPlan& plan) : plan_(plan), summary_(plan.summary, plan.overwrite), start_(monotonic_seconds()) {
    result_.command = plan.command;
    result_.unit = plan.unit;
    result_.jobs = plan.jobs.of(plan.inputs.size(), plan.threads);
  }

  int run() {
    run_workers({.count = plan_.inputs.size(),
                 .jobs = result_.jobs,
                 .threads = plan_.threads,
                 .work = [this](std::size_t run, const Share& share, std::string& told) { return guarded([&] { return plan_.work(run, share, told); }, told); },
                 .begin = [this](std::size_t run) { begin(run); },
                 .end = [this](std::size_t run, WorkerEnd& end) { take(run, end); }});
    result_.seconds = monotonic_seconds() - start_;
    if (summary_.wanted()) summary_.write(to_json(result_, false));
    if (plan_.json)
      write_stdout(to_json(result_, true));
    else if (plan_.verbosity != Verbosity::quiet)
      write_stdout(table_of(result_) + "\n" + closing_of(result_));
    return result_.exit_code();
  }

 private:
  void begin(std::size_t run) const {
    if (plan_.verbosity != Verbosity::quiet) write_stderr(fmt::format("[{}/{}] {}\n", run + 1, plan_.inputs.size(), plan_.inputs[run]));
  }

  void take(std::size_t run, WorkerEnd& end) {
    write_stderr(end.err);
    if (!end.out.empty()) write_stdout(end.out);
    BatchFile& file = result_.files.emplace_back();
    file.input = plan_.inputs[run];
    if (!plan_.outputs.empty()) file.output = plan_.outputs[run];
    file.exit_code = end.code;
    file.seconds = end.seconds;
    file.told = std::move(end.told);
    read_told(file);
    if (!plan_.json) file.told.clear();
  }

  const BatchPlan& plan_;
  ReportFile summary_;
  BatchResult result_;
  double start_;
};

}  // namespace

int Jobs::of(std::size_t runs, int threads) const {
  int wanted = count > 0 ? count : static_cast<int>(std::thread::hardware_concurrency());
  if (threads > 0) wanted = std::min(wanted, threads);
  return std::max(1, std::min(wanted, static_cast<int>(std::min<std::size_t>(runs, 4096))));
}

Setter add_input(std::vector<std::string>& inputs) {
  return [&inputs](const GivenValue& v) { store_text(inputs.emplace_back())(v); };
}

Option jobs_row(std::string_view group, Jobs& jobs) {
  return {"--jobs", 0, number("N", {"auto"}), group, "Of several inputs, N at once (0 or 'auto': one for each processor), each with its part of --threads and --memory. No result depends on it.",
          [&jobs](const GivenValue& v) { jobs.count = is_listed(v) ? 0 : static_cast<int>(integer_within(v, 0, 4096)); }};
}

int run_batch(const BatchPlan& plan) { return Batch(plan).run(); }

}  // namespace burnish
