#include "model_units.h"

#include <fmt/format.h>

#include <array>

#include "burnish/core/text.h"

namespace burnish {
namespace {

constexpr double kSmall = 0.005, kLarge = 2;  // of the mesh's diagonal: what a model in it is between

bool meet(const Box3& a, const Box3& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (a.upper[axis] < b.lower[axis] || b.upper[axis] < a.lower[axis]) return false;
  return true;
}

bool is_in(const Box3& box, const Vec3& p) { return meet(box, {p, p}); }

bool fits(const Box3& solid, const Box3& mesh, double scale) {
  const double ratio = scale * solid.diagonal() / mesh.diagonal();
  return ratio >= kSmall && ratio <= kLarge && is_in(mesh, solid.center() * scale);
}

// A unit that the model may be in: millimetres first, then other powers of ten, and inches.
std::optional<double> scale_that_fits(const Box3& solid, const Box3& mesh) {
  constexpr std::array<double, 9> kScales{1e-3, 1e3, 1e-2, 1e2, 1e-1, 1e1, 1e-6, 1e6, 0.0254};
  for (const double s : kScales)
    if (fits(solid, mesh, s)) return s;
  return std::nullopt;
}

}  // namespace

UnitsCheck check_units(const Box3& solid, const Box3& mesh, double scale) {
  UnitsCheck result;
  const double ratio = solid.diagonal() / mesh.diagonal();
  const bool apart = !meet(solid, mesh);
  const bool strange = ratio < kSmall || ratio > kLarge;  // else it is only in another place
  const std::optional<double> other = strange ? scale_that_fits(solid, mesh) : std::nullopt;
  const std::string way_out = other ? fmt::format("if its unit is another, --scale {:g} would fit", *other * scale) : "";
  const std::string boxes = fmt::format("the model is in {}, the mesh in {}", text_of(solid), text_of(mesh));
  if (apart)
    result.failure = Error(ErrorCode::guarantee_unmet, "the model and the mesh do not overlap: " + boxes, other ? way_out : "move the model, or name another --case or --region");
  else if (ratio > kLarge || other)  // a small one without another unit may be meant
    result.warning = fmt::format("the model is {:.3g} times as large as the mesh: {}{}{}", ratio, boxes, other ? "; " : "", way_out);
  return result;
}

}  // namespace burnish
