// 3MF files (3MF Core Specification 1.3): read by lib3mf where the build has it, written by code of ours.
//
// lib3mf 1.8 writes six decimals, whatever the size of the model, and random UUIDs; here every coordinate comes back, and the same model gives the same bytes.
#pragma once

#include <string_view>

#include "burnish/core/error.h"
#include "burnish/io/mesh_io.h"
#include "fd_writer.h"

namespace burnish {

// The material of facets without a colour, in files of ours. Its own colour is for programs that do not know it.
inline constexpr std::string_view kUncoloured = "uncoloured";

// Throws Error{code} that names `path` in a build without lib3mf: what cannot be read back is not written either.
void require_3mf(const std::string& path, ErrorCode code);

// One object for each group if every one of them is closed by itself, as the specification asks of an object; one object otherwise.
void write_3mf(FdWriter& out, const std::string& label, const TriangleSoup& soup, const MeshWriteOptions& options);

}  // namespace burnish
