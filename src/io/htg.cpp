#include <fmt/format.h>

#include "cell_stream.h"

namespace burnish::detail {
namespace {

// Octants level by level from the root, each level in Morton order: VTK's breadth-first order of children x fastest.
class HtgWriter {
 public:
  HtgWriter(int fd, const std::string& label, const CellGrid& grid, Progress& progress)
      : out_(fd, label), grid_(grid), progress_(progress), smallest_(smallest_level(grid, label)) {}

  WrittenField write() {
    list_octants();
    put_head();
    put_arrays();
    out_.finish();
    return {grid_.count, 0, count_};
  }

 private:
  struct Level {
    std::vector<std::uint64_t> keys;  // in units of the level's octants, ascending
    std::vector<char> refined;
  };

  // Goes up from each cube to the first octant that the cube before has, too.
  void list_octants() {
    levels_.resize(static_cast<std::size_t>(grid_.depth - smallest_) + 1);
    for (std::size_t first = 0; first < grid_.count; first += kPortion) {
      progress_.check();
      for (const LatticeCube& cube : cubes_of(grid_, first, std::min(first + kPortion, grid_.count))) add(cube);
    }
    for (const Level& level : levels_) {
      first_.push_back(count_);
      count_ += level.keys.size();
    }
  }

  void add(const LatticeCube& cube) {
    LatticePoint p = cube.corner;
    for (std::int32_t& c : p) c >>= cube.level;
    std::uint64_t key = morton_key(p);
    for (int l = cube.level; l <= grid_.depth; ++l, key >>= 3) {
      Level& level = levels_[static_cast<std::size_t>(grid_.depth - l)];
      if (!level.keys.empty() && level.keys.back() == key) return;
      level.keys.push_back(key);
      level.refined.push_back(l > cube.level);
    }
  }

  std::size_t descriptor_bits() const { return count_ - levels_.back().keys.size(); }

  void put_head() {
    out_.text(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"HyperTreeGrid\" version=\"2.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" "
        "compressor=\"vtkZLibDataCompressor\">\n  <HyperTreeGrid BranchFactor=\"2\" TransposedRootIndexing=\"0\" Dimensions=\"2 2 2\">\n"
        "    <Grid>\n");
    for (const char* name : {"XCoordinates", "YCoordinates", "ZCoordinates"}) out_.announce("Float64", name, 2);
    out_.text("    </Grid>\n    <Trees>\n");
    out_.announce("Bit", "Descriptors", descriptor_bits());
    out_.announce("Int64", "NumberOfVerticesPerDepth", levels_.size());
    out_.announce("Int64", "TreeIds", 1);
    out_.announce("UInt32", "DepthPerTree", 1);
    out_.text("    </Trees>\n    <CellData>\n");
    for (const auto& array : grid_.cell_arrays) out_.announce(vtk_name(array.type), array.name, count_);
    out_.text("    </CellData>\n  </HyperTreeGrid>\n");
    out_.begin_data();
  }

  template <class T>
  void put_whole(const std::vector<T>& values) {
    out_.begin_array(values.size() * sizeof(T));
    out_.put(values.data(), values.size() * sizeof(T));
    out_.end_array();
  }

  void put_arrays() {
    const double side = grid_.cell * static_cast<double>(std::int64_t{1} << grid_.depth);
    for (int a = 0; a < 3; ++a) put_whole(std::vector<double>{grid_.origin[a], grid_.origin[a] + side});
    put_whole(descriptor());
    std::vector<std::int64_t> sizes;
    for (const Level& level : levels_) sizes.push_back(static_cast<std::int64_t>(level.keys.size()));
    put_whole(sizes);
    put_whole(std::vector<std::int64_t>{0});
    put_whole(std::vector<std::uint32_t>{static_cast<std::uint32_t>(levels_.size())});
    for (const auto& array : grid_.cell_arrays)
      put_item_array(out_, array, count_, progress_, [&](std::size_t begin, std::size_t end) { return octants(begin, end); });
  }

  // A bit for each octant above the last level, the first in the highest bit of a byte.
  std::vector<std::uint8_t> descriptor() const {
    std::vector<std::uint8_t> bytes((descriptor_bits() + 7) / 8, 0);
    std::size_t bit = 0;
    for (std::size_t l = 0; l + 1 < levels_.size(); ++l)
      for (const char refined : levels_[l].refined) {
        if (refined) bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] | 0x80 >> bit % 8);
        ++bit;
      }
    return bytes;
  }

  std::vector<LatticeCube> octants(std::size_t begin, std::size_t end) const {
    std::vector<LatticeCube> result;
    std::size_t l = static_cast<std::size_t>(std::upper_bound(first_.begin(), first_.end(), begin) - first_.begin()) - 1;
    for (std::size_t o = begin; o < end; ++o) {
      while (o - first_[l] >= levels_[l].keys.size()) ++l;
      const int level = grid_.depth - static_cast<int>(l);
      LatticeCube cube{morton_point(levels_[l].keys[o - first_[l]]), level};
      for (std::int32_t& c : cube.corner) c <<= level;
      result.push_back(cube);
    }
    return result;
  }

  VtkAppended out_;
  const CellGrid& grid_;
  Progress& progress_;
  const int smallest_;
  std::vector<Level> levels_;       // the root's first
  std::vector<std::size_t> first_;  // number of each level's first octant
  std::size_t count_ = 0;           // octants of all levels
};

}  // namespace

WrittenField write_htg(int fd, const std::string& label, const CellGrid& grid, Progress& progress) {
  return HtgWriter(fd, label, grid, progress).write();
}

}  // namespace burnish::detail
