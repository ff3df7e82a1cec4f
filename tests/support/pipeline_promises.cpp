#include "support/pipeline_promises.h"

#include <fcntl.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <optional>

#include "burnish/io/mesh_io.h"
#include "burnish/pipeline/clean.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/weld.h"
#include "support/shapes.h"

namespace burnish::test {
namespace {

constexpr std::size_t kMostFacets = 40;
constexpr int kMostDamages = 3;  // of at least four facets: something is always left

// Bytes one after the other; zeros when they are used up.
class Bytes {
 public:
  explicit Bytes(const std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}
  bool empty() const { return next_ >= bytes_.size(); }
  std::uint8_t take() { return empty() ? std::uint8_t{0} : bytes_[next_++]; }
  int below(int n) { return take() % n; }

 private:
  const std::vector<std::uint8_t>& bytes_;
  std::size_t next_ = 0;
};

enum class Points { lattice, half_lattice, shifted_lattice, anywhere };

double coordinate(Bytes& bytes, Points kind) {
  switch (kind) {
    case Points::lattice: return bytes.below(4);
    case Points::half_lattice: return 0.5 * bytes.below(9);
    case Points::shifted_lattice: return 1000.1 + 0.3 * bytes.below(5);
    case Points::anywhere: break;
  }
  // One in 16 is of another order of magnitude than the others.
  const double mantissa = (256 * bytes.take() + bytes.take()) / 65536.0 - 0.5;
  const std::uint8_t scale = bytes.take();
  return scale % 16 == 0 ? std::ldexp(mantissa, scale / 16 * 8 - 64) : mantissa;
}

Vec3 point(Bytes& bytes, Points kind) {
  const double x = coordinate(bytes, kind), y = coordinate(bytes, kind), z = coordinate(bytes, kind);
  return {x, y, z};
}

// Facets between points that many of them share.
void add_random_facets(TriangleSoup& soup, Bytes& bytes, Points kind) {
  const int points = 4 + bytes.below(13);
  for (int i = 0; i < points; ++i) soup.points.push_back(point(bytes, kind));
  const auto corner = [&] { return static_cast<std::uint32_t>(bytes.below(points)); };
  do {
    const std::uint32_t a = corner(), b = corner(), c = corner();
    soup.facets.push_back({a, b, c});
  } while (!bytes.empty() && soup.facets.size() < kMostFacets);
}

// One to three boxes or tetrahedra, which touch and overlap in all ways; some of their facets turned over or left out.
void add_bodies(TriangleSoup& soup, Bytes& bytes, Points kind) {
  for (int body = 1 + bytes.below(3); body > 0; --body) {
    const bool is_box = bytes.below(2) == 0;
    const Vec3 a = point(bytes, kind), b = point(bytes, kind);
    const auto in_box = [&](const Vec3& p) { return Vec3{a.x + p.x * (b.x - a.x), a.y + p.y * (b.y - a.y), a.z + p.z * (b.z - a.z)}; };
    if (is_box) {
      soup = merged(soup, mapped(cube(), in_box));
    } else {
      const Vec3 c = point(bytes, kind), d = point(bytes, kind);
      soup = merged(soup, tetrahedron(a, b, c, d));
    }
  }
  for (int damages = 0; damages < kMostDamages && !bytes.empty(); ++damages) {
    const std::uint8_t byte = bytes.take();
    const std::size_t f = byte / 2 % soup.facets.size();
    soup = byte % 2 ? with_flipped_facet(soup, f) : without_facets(soup, {f});
  }
}

CleanOptions options_of(Bytes& bytes) {
  CleanOptions options;
  options.resolution = 8 + bytes.below(17);
  options.memory_bytes = std::uint64_t{1} << 30;
  const int smoothing = bytes.below(8);
  if (smoothing >= 5) options.smooth = {1.5 * (smoothing - 4), LengthUnit::cells};
  if (smoothing == 7) options.deviation = Length{1, LengthUnit::cells};
  return options;
}

void write_file(const std::string& path, const TriangleSoup& soup) {
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  write_mesh(fd, path, soup, {.format = format_for_writing(path)});
  ::close(fd);
}

std::string flaw_of_report(const RepairReport& report, bool exists) {
  if (report.verified != !report.failure) return "verified and failed, or neither";
  if (report.written != report.verified) return "written is not what verified says";
  if (exists != report.written) return report.written ? "no file" : "a file, though nothing was written";
  if (report.failure && report.failure->code() != ErrorCode::guarantee_unmet) return "a failure of another kind";
  if (report.failure && report.failure->hint().empty()) return "a failure without a hint";
  return "";
}

std::string flaw_of_file(const std::string& path, const RepairReport& report) {
  const Defects found = inspect(weld(read_mesh(path).soup)).defects;
  if (!found.valid_solid()) return "verified, but the file is no valid solid";
  if (found.facets != report.after.facets || found.volume != report.after.volume) return "the file is not what the report describes";
  return "";
}

std::string run(const CleanJob& job) {
  try {
    const RepairReport report = clean(job);
    const std::string flaw = flaw_of_report(report, std::filesystem::exists(job.output));
    return flaw.empty() && report.written ? flaw_of_file(job.output, report) : flaw;
  } catch (const Error& error) {
    if (std::filesystem::exists(job.output)) return "an error, and a file";
    const bool documented = error.code() == ErrorCode::unreadable_input || error.code() == ErrorCode::memory_limit;
    return documented ? "" : std::string("undocumented error: ") + error.what();
  }
}

}  // namespace

SmallJob small_job(const std::vector<std::uint8_t>& data) {
  Bytes bytes(data);
  SmallJob job;
  job.options = options_of(bytes);
  const int mode = bytes.below(16);
  job.double_precision = mode / 4 % 2 == 1;
  const auto kind = static_cast<Points>(mode % 4);
  if (mode < 8) {
    add_random_facets(job.soup, bytes, kind);
  } else {
    add_bodies(job.soup, bytes, kind);
  }
  return job;
}

std::string broken_promise(const SmallJob& small, const std::string& folder) {
  const std::string suffix = small.double_precision ? ".ply" : ".stl";
  CleanJob job;
  job.input = folder + "/in" + suffix;
  job.output = folder + "/out" + suffix;
  job.options = small.options;
  write_file(job.input, small.soup);
  const std::string flaw = run(job);
  std::error_code ignored;
  for (const std::string& path : {job.input, job.output}) std::filesystem::remove(path, ignored);
  if (flaw.empty() && !std::filesystem::is_empty(folder)) return "something was left in the folder";
  return flaw;
}

}  // namespace burnish::test
