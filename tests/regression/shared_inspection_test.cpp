// Thickness and alignment of real scans, by what has to hold of any: motions that are known, triangles that are cut, the way through the solid.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <random>
#include <string>

#include "burnish/io/mesh_io.h"
#include "burnish/surface/registration.h"
#include "burnish/surface/thickness.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/weld.h"
#include "support/motions.h"
#include "support/shapes.h"
#include "support/shared_data.h"

namespace burnish {
namespace {

using namespace test;

std::optional<TriangleSoup> scan(const std::string& name) {
  const std::filesystem::path file = data_folder() / "common" / (name + ".stl");
  if (!std::filesystem::exists(file)) return std::nullopt;
  return weld(read_mesh(file.string()).soup).soup;
}
