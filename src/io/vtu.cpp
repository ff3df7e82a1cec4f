#include <bit>

#include "cell_stream.h"

namespace burnish::detail {
namespace {

constexpr std::uint8_t kVoxel = 11;  // corners x fastest, then y, then z

// Keys of a range's corners, each once, and a number for each. Open addressing, for no more keys than it was made for.
class KeyTable {
 public:
  explicit KeyTable(std::size_t most) : mask_(std::bit_ceil(2 * most) - 1), keys_(mask_ + 1, kEmpty), numbers_(mask_ + 1) {}

  // False if it was there already.
  bool insert(std::uint64_t key) {
    const std::size_t s = slot(key);
    if (keys_[s] == key) return false;
    keys_[s] = key;
    return true;
  }
  std::int64_t& number(std::uint64_t key) { return numbers_[slot(key)]; }

 private:
  static constexpr std::uint64_t kEmpty = ~std::uint64_t{0};  // no key has the highest bit

  std::size_t slot(std::uint64_t key) const {
    std::size_t s = (key * 0x9e3779b97f4a7c15ull >> 32) & mask_;
    while (keys_[s] != key && keys_[s] != kEmpty) s = (s + 1) & mask_;
    return s;
  }

  std::size_t mask_;
  std::vector<std::uint64_t> keys_;
  std::vector<std::int64_t> numbers_;
};

class VtuWriter {
 public:
  VtuWriter(int fd, const std::string& label, const CellGrid& grid, Progress& progress)
      : out_(fd, label), grid_(grid), progress_(progress), smallest_(smallest_level(grid, label)) {}

  WrittenField write() {
    number_points();
    put_head();
    put_arrays();
    out_.finish();
    return {grid_.count, points_.size(), 0};
  }

 private:
  std::uint64_t key_of_corner(const LatticeCube& cube, int corner) const {
    LatticePoint p = cube.corner;
    for (std::size_t a = 0; a < 3; ++a) p[a] = (p[a] + ((corner >> a & 1) << cube.level)) >> smallest_;
    return morton_key(p);
  }

  LatticePoint point(std::size_t p) const {
    LatticePoint at = morton_point(points_[p]);
    for (std::int32_t& c : at) c <<= smallest_;
    return at;
  }

  std::vector<LatticePoint> points_of(std::size_t begin, std::size_t end) const {
    std::vector<LatticePoint> result;
    for (std::size_t p = begin; p < end; ++p) result.push_back(point(p));
    return result;
  }

  // Keys of the cubes' corners in order, without copies.
  std::vector<std::uint64_t> keys_of(const std::vector<LatticeCube>& cubes, KeyTable& table) const {
    std::vector<std::uint64_t> keys;
    for (const LatticeCube& cube : cubes)
      for (int corner = 0; corner < 8; ++corner)
        if (const std::uint64_t key = key_of_corner(cube, corner); table.insert(key)) keys.push_back(key);
    std::sort(keys.begin(), keys.end());
    return keys;
  }

  // Ranges of cubes in Morton order have few points in common with others, so copies are few before the last step.
  void number_points() {
    for (std::size_t first = 0; first < grid_.count; first += kPortion) {
      progress_.check();
      const std::size_t n = std::min(kPortion, grid_.count - first);
      std::vector<std::vector<std::uint64_t>> parts((n + kRange - 1) / kRange);
      parallel_ranges(n, kRange, [&](std::size_t begin, std::size_t end) {
        KeyTable table(8 * (end - begin));
        parts[begin / kRange] = keys_of(cubes_of(grid_, first + begin, first + end), table);
      });
      for (const auto& part : parts) points_.insert(points_.end(), part.begin(), part.end());
    }
    parallel_sort(points_);
    points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
  }

  void put_head() {
    out_.text(vtu_opening(points_.size(), grid_.count) + "      <PointData>\n");
    for (const auto& array : grid_.point_arrays) out_.announce(vtk_name(array.type), array.name, points_.size());
    out_.text("      </PointData>\n      <CellData>\n");
    for (const auto& array : grid_.cell_arrays) out_.announce(vtk_name(array.type), array.name, grid_.count);
    out_.text("      </CellData>\n      <Points>\n");
    out_.announce("Float64", "Points", points_.size(), 3);
    out_.text("      </Points>\n      <Cells>\n");
    out_.announce("Int64", "connectivity", 8 * grid_.count);
    out_.announce("Int64", "offsets", grid_.count);
    out_.announce("UInt8", "types", grid_.count);
    out_.text("      </Cells>\n    </Piece>\n  </UnstructuredGrid>\n");
    out_.begin_data();
  }

  void put_arrays() {
    for (const auto& array : grid_.point_arrays)
      put_item_array(out_, array, points_.size(), progress_, [&](std::size_t begin, std::size_t end) { return points_of(begin, end); });
    for (const auto& array : grid_.cell_arrays)
      put_item_array(out_, array, grid_.count, progress_, [&](std::size_t begin, std::size_t end) { return cubes_of(grid_, begin, end); });
    put_array(out_, points_.size(), sizeof(Vec3), progress_, [&](std::size_t begin, std::size_t end, char* to) {
      for (std::size_t p = begin; p < end; ++p, to += sizeof(Vec3)) {
        const LatticePoint at = point(p);
        const Vec3 q{static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])};
        const Vec3 model = grid_.origin + q * grid_.cell;
        std::memcpy(to, &model, sizeof model);
      }
    });
    put_array(out_, grid_.count, 8 * sizeof(std::int64_t), progress_,
              [&](std::size_t begin, std::size_t end, char* to) { put_corners(begin, end, to); });
    put_array(out_, grid_.count, sizeof(std::int64_t), progress_, [&](std::size_t begin, std::size_t end, char* to) {
      for (std::size_t c = begin; c < end; ++c) {
        const auto last = static_cast<std::int64_t>(8 * (c + 1));
        std::memcpy(to + (c - begin) * sizeof last, &last, sizeof last);
      }
    });
    put_array(out_, grid_.count, 1, progress_, [](std::size_t begin, std::size_t end, char* to) { std::memset(to, kVoxel, end - begin); });
  }

  // The range's keys in order stand in the same order among all: each is looked for from the one before it on.
  void put_corners(std::size_t begin, std::size_t end, char* to) const {
    const std::vector<LatticeCube> cubes = cubes_of(grid_, begin, end);
    KeyTable table(8 * cubes.size());
    auto at = points_.begin();
    for (const std::uint64_t key : keys_of(cubes, table)) {
      std::ptrdiff_t step = 1;
      while (step < points_.end() - at && *(at + step) < key) step *= 2;
      at = std::lower_bound(at, at + std::min(step + 1, points_.end() - at), key);
      table.number(key) = at - points_.begin();
    }
    for (const LatticeCube& cube : cubes)
      for (int corner = 0; corner < 8; ++corner, to += sizeof(std::int64_t))
        std::memcpy(to, &table.number(key_of_corner(cube, corner)), sizeof(std::int64_t));
  }

  VtkAppended out_;
  const CellGrid& grid_;
  Progress& progress_;
  const int smallest_;
  std::vector<std::uint64_t> points_;  // keys, in units of the smallest cubes, ascending
};

}  // namespace

WrittenField write_vtu(int fd, const std::string& label, const CellGrid& grid, Progress& progress) {
  return VtuWriter(fd, label, grid, progress).write();
}

}  // namespace burnish::detail
