#include "burnish/io/vdb.h"

#include <fmt/format.h>
#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <cmath>
#include <new>
#include <sstream>
#include <string_view>

#include "burnish/core/parallel.h"
#include "fd_writer.h"

namespace burnish {
namespace {

using openvdb::FloatGrid;
using openvdb::FloatTree;
using Leaf = FloatTree::LeafNodeType;

constexpr std::size_t kUuid = 36;       // characters
constexpr std::size_t kBatch = 4096;    // blocks computed between two looks at whether to go on
static_assert(Leaf::SIZE == kVdbBlockVoxels);

// With a table of offsets, which files have and streams have not.
class Archive : public openvdb::io::Archive {
 public:
  void write_to(std::ostream& out, const openvdb::GridCPtrVec& grids) const { write(out, grids, true); }
};

// Ours are x fastest, OpenVDB's z.
std::size_t our_voxel(openvdb::Index offset) { return (offset >> 6) + 8 * (offset >> 3 & 7) + 64 * (offset & 7); }

// Whether some voxel is within the band.
bool fill_leaf(const std::span<const float> phi, float background, Leaf& leaf) {
  bool any = false;
  for (openvdb::Index v = 0; v < Leaf::SIZE; ++v) {
    const float value = -phi[our_voxel(v)];
    const bool active = std::abs(value) < background;
    if (active)
      leaf.setValueOn(v, value);
    else
      leaf.setValueOff(v, value < 0 ? -background : background);
    any |= active;
  }
  return any;
}

// Blocks are computed on several threads and handed to the tree in order.
void add_blocks(const VdbSource& source, float background, FloatTree& tree, Progress& progress) {
  std::vector<std::unique_ptr<Leaf>> leaves;
  for (std::size_t first = 0; first < source.blocks.size(); first += kBatch) {
    progress.check();
    leaves.clear();
    leaves.resize(std::min(kBatch, source.blocks.size() - first));
    parallel_for(leaves.size(), [&](std::size_t i) {
      std::array<float, kVdbBlockVoxels> phi;
      source.fill(first + i, phi);
      const auto& corner = source.blocks[first + i];
      auto leaf = std::make_unique<Leaf>(openvdb::Coord(corner[0], corner[1], corner[2]), background, false);
      if (fill_leaf(phi, background, *leaf)) leaves[i] = std::move(leaf);
    }, 8);
    for (auto& leaf : leaves)
      if (leaf) tree.addLeaf(leaf.release());
  }
}

FloatGrid::Ptr grid_of(const VdbSource& source, Progress& progress) {
  const auto background = static_cast<float>(source.half_width * source.voxel);
  FloatGrid::Ptr grid = FloatGrid::create(background);
  grid->setName(source.name);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  auto transform = openvdb::math::Transform::createLinearTransform(source.voxel);
  transform->postTranslate({source.origin.x, source.origin.y, source.origin.z});
  grid->setTransform(transform);
  add_blocks(source, background, grid->tree(), progress);
  openvdb::tools::signedFloodFill(grid->tree());
  openvdb::tools::pruneLevelSet(grid->tree());
  return grid;
}

std::uint64_t hash_of(std::string_view bytes, std::uint64_t hash) {
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  return hash;
}

// The identifier stands behind the magic number, three versions, and whether there are offsets.
void replace_uuid(std::string& bytes) {
  constexpr std::size_t at = 8 + 3 * 4 + 1;
  if (bytes.size() < at + kUuid || bytes[at + 8] != '-' || bytes[at + 23] != '-') return;
  const std::string_view rest = std::string_view(bytes).substr(at + kUuid);
  const std::uint64_t a = hash_of(rest, 0xcbf29ce484222325ull), b = hash_of(rest, a);
  // Version 8, variant 1: of a kind of one's own.
  bytes.replace(at, kUuid, fmt::format("{:08x}-{:04x}-8{:03x}-{:04x}-{:012x}", a >> 32, a >> 16 & 0xffff, a & 0xfff, 0x8000 | (b >> 48 & 0x3fff), b & 0xffffffffffff));
}

std::string bytes_of(const FloatGrid::Ptr& grid) {
  std::ostringstream out(std::ios::binary);
  Archive archive;
  archive.setCompression(openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK);
  archive.write_to(out, {grid});
  std::string bytes = std::move(out).str();
  replace_uuid(bytes);
  return bytes;
}

}  // namespace

bool has_openvdb() { return true; }

void require_openvdb(const std::string&) {}

WrittenVdb write_vdb(int fd, const std::string& label, const VdbSource& source, Progress& progress) {
  openvdb::initialize();
  const FloatGrid::Ptr grid = grid_of(source, progress);
  FdWriter out(fd, label);
  out.put(bytes_of(grid));
  out.flush();
  return {grid->activeVoxelCount(), grid->tree().leafCount()};
}

}  // namespace burnish
