// What a finished volume mesh is, beside the surface that it was made for.
#pragma once

#include "burnish/core/progress.h"
#include "burnish/pipeline/flow_mesh_job.h"
#include "flow_mesh_patches.h"

namespace burnish {

// Sizes, patches, the wanted volume and regions of a mesh of `result.solid`.
void tell_mesh(const FlowMesh& mesh, const SurfacePatches& patches, const Box3& domain, FlowMeshResult& result);

// Quality, whether it is what it has to be, and if not, where it fails. The mesh's coordinates are those of the model times `scale`; what is told is in the model's units.
void judge_quality(const VolumeMesh& mesh, double scale, FlowMeshResult& result, Progress& progress);

// Distances between the surface and the patches made for it, and what is lost of the surface.
void compare_patches(const VolumeMesh& mesh, const SurfacePatches& patches, const TriangleSoup& surface, FlowMeshResult& result);

// Why a mesh of that quality is not written.
Error reason_of_failure(const FlowMeshResult& result);

}  // namespace burnish
