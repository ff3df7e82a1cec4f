// The surface of a level set: extracted, sharpened, and mended where the written file turns out to be broken.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/extract/delaunay.h"
#include "burnish/extract/marching_tetrahedra.h"
#include "burnish/extract/reference_surface.h"
#include "burnish/extract/sharpen.h"
#include "burnish/levelset/level_set.h"
#include "burnish/levelset/topology.h"
#include "burnish/pipeline/report.h"
#include "burnish/surface/validate.h"
#include "prepare_input.h"

namespace burnish {

// What an extracted surface is to lie on, in lattice coordinates.
struct SharpReference {
  ReferenceSurface surface;
  std::vector<std::vector<Vec3>> sharp;  // its creases but for the shallow ones, as polylines
};

class SurfaceMaker {
 public:
  // `reference`: the facets that bound the solid, in lattice coordinates, where they are what the level set was built from; null where it has moved since.
  // `float32`: of that precision the file is that the surface is for. All have to outlive the maker, which tells report.surface, report.actions and report.warnings.
  SurfaceMaker(const LevelSet& level_set, const PreparedInput& prepared, std::shared_ptr<const SharpReference> reference, bool float32, RepairReport& report,
               Progress& progress);

  // The surface in lattice coordinates, without debris.
  const TriangleSoup& make();

  // What the surface's topology has to be: the level set's, without debris.
  struct Topology {
    std::size_t components = 0;
    std::int64_t genus = 0;
  };
  const Topology& wanted_topology() const { return wanted_; }

  // Takes back, around these facets of the surface last made, what may have broken them: what sharpening has moved, then what snapping has; a Delaunay
  // surface gives way to tetrahedra in the end. False if there is nothing left to take back.
  bool mend(const std::vector<std::uint32_t>& facets);

 private:
  void choose_extractor();
  DelaunayOptions delaunay_options() const;
  SharpenOptions sharpen_options() const;
  void extract();
  bool extract_by_delaunay();
  void extract_by_tetrahedra();
  void use_tetrahedra(const std::string& why);
  void sharpen_and_settle();
  void give_up_sharpening();
  bool leave_unsnapped(const std::vector<std::uint32_t>& facets);

  const LevelSet& set_;
  const PreparedInput& prepared_;
  std::shared_ptr<const SharpReference> reference_;
  bool float32_;
  RepairReport& report_;
  Progress& progress_;

  std::optional<LevelSetTopology> field_;     // once it was asked for
  Topology wanted_;
  Extractor extractor_ = Extractor::automatic;
  ExtractedSurface raw_;                      // before sharpening; no facets: to be extracted
  std::optional<Sharpening> sharpening_;
  TriangleSoup sharpened_;
  PlainNodes plain_;
  int mended_ = 0;
};

// The facets that bound the solid with their creases, for sharpening: `surface` is in lattice coordinates, sigma (in cells) the noise's standard deviation.
// Without an angle: kCreaseAngle, and shallower edges too where facets are as wide as cells.
std::shared_ptr<const SharpReference> make_reference(TriangleSoup surface, std::optional<double> crease_angle, double sigma);

}  // namespace burnish
