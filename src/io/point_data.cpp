#include "burnish/io/point_data.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "fd_writer.h"
#include "vtp_stream.h"

namespace burnish {
namespace {

void announce(VtpStream& vtp, std::string_view element, const std::vector<PointArray>& arrays) {
  if (arrays.empty()) return;
  vtp.open_element(fmt::format("{} Scalars=\"{}\"", element, arrays.front().name));
  for (const PointArray& array : arrays) vtp.announce("Float64", array.name, array.components, 8 * array.values.size());
  vtp.close_element(element);
}

void put(VtpStream& vtp, FdWriter& out, const std::vector<PointArray>& arrays) {
  for (const PointArray& array : arrays) {
    vtp.put_size(8 * array.values.size());
    for (const double v : array.values) out.put_raw(v);
  }
}

void write_vtp(FdWriter& out, const PointData& data) {
  const TriangleSoup& s = data.surface;
  VtpStream vtp(out);
  vtp.open();
  vtp.open_piece(s.points.size(), 0, 0, s.facets.size());
  announce(vtp, "PointData", data.arrays);
  announce(vtp, "CellData", data.facet_arrays);
  vtp.announce_points(s.points.size());
  vtp.announce_cells("Verts", 1, 0);
  vtp.announce_cells("Lines", 2, 0);
  vtp.announce_cells("Polys", 3, s.facets.size());
  vtp.begin_data();
  put(vtp, out, data.arrays);
  put(vtp, out, data.facet_arrays);
  vtp.put_points(s.points);
  const auto none = [](std::size_t, std::size_t) { return 0; };
  vtp.put_cells(1, 0, none);
  vtp.put_cells(2, 0, none);
  vtp.put_cells(3, s.facets.size(), [&](std::size_t f, std::size_t i) { return s.facets[f][i]; });
  vtp.close();
}

double range_of(const std::vector<double>& values) {
  double range = 0;
  for (const double v : values)
    if (!std::isnan(v)) range = std::max(range, std::abs(v));
  return range;
}

double number_of(double value) { return std::isnan(value) ? 0 : value; }

std::vector<std::string> properties_of(const PointArray& array) {
  if (array.components == 1) return {array.name};
  if (array.name == "normal") return {"nx", "ny", "nz"};
  return {array.name + "_x", array.name + "_y", array.name + "_z"};
}

void write_ply(FdWriter& out, const PointData& data) {
  const TriangleSoup& s = data.surface;
  const PointArray& colored = data.arrays.front();
  const double range = data.color_range > 0 ? data.color_range : range_of(colored.values);
  out.put("ply\nformat binary_little_endian 1.0\ncomment burnish\n");
  for (const std::string& comment : data.comments) out.put(fmt::format("comment {}\n", comment));
  out.put(fmt::format("comment colours {} from {} (blue) by 0 (grey) to {} (red)\n", colored.name, 0.0 - range, range));
  out.put(fmt::format("element vertex {}\nproperty double x\nproperty double y\nproperty double z\n", s.points.size()));
  for (const PointArray& array : data.arrays)
    for (const std::string& property : properties_of(array)) out.put(fmt::format("property double {}\n", property));
  out.put("property uchar red\nproperty uchar green\nproperty uchar blue\n");
  out.put(fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n", s.facets.size()));
  for (std::size_t p = 0; p < s.points.size(); ++p) {
    out.put_raw(s.points[p]);
    for (const PointArray& array : data.arrays)
      for (int c = 0; c < array.components; ++c) out.put_raw(number_of(array.values[p * static_cast<std::size_t>(array.components) + static_cast<std::size_t>(c)]));
    const Color color = diverging_color(number_of(colored.values[p]), range);
    for (int i = 0; i < 3; ++i) out.put_raw(static_cast<std::uint8_t>(channel(color, i)));
  }
  for (const Facet& f : s.facets) {
    out.put_raw(std::uint8_t{3});
    out.put_raw(f);
  }
}

}  // namespace

// The ends and the middle of Moreland's diverging map (2009), with straight lines between them.
Color diverging_color(double value, double range) {
  constexpr std::array<double, 3> kBlue{59, 76, 192}, kGrey{221, 221, 221}, kRed{180, 4, 38};
  const double t = range > 0 ? std::clamp(value / range, -1.0, 1.0) : 0;
  const std::array<double, 3>& end = t < 0 ? kBlue : kRed;
  const auto mixed = [&](std::size_t i) {
    return static_cast<std::uint32_t>(std::lround(kGrey[i] + (end[i] - kGrey[i]) * std::abs(t)));
  };
  return color_of(mixed(0), mixed(1), mixed(2));
}

void write_point_data(int fd, const std::string& label, const PointData& data, MarkedFormat format) {
  assert(!data.arrays.empty() || (format == MarkedFormat::vtp && !data.facet_arrays.empty()));
  FdWriter out(fd, label);
  if (format == MarkedFormat::vtp)
    write_vtp(out, data);
  else
    write_ply(out, data);
  out.flush();
}

}  // namespace burnish
