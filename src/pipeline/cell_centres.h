// Where a cell's value is thought to be.
#pragma once

#include <vector>

#include "burnish/volume/polyhedral_mesh.h"

namespace burnish {

// Centroids as OpenFOAM's primitiveMesh computes them: faces by their triangles about the mean of their points, weighted by area; cells by the pyramids
// from the mean of the faces' centroids. Its cell centres, to rounding.
std::vector<Vec3> cell_centres(const PolyhedralMesh& mesh, const CellFaces& faces);

}  // namespace burnish
