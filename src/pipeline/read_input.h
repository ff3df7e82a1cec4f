// How every run begins: the input is read, then prepared, or found to bound no solid.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "burnish/pipeline/options.h"
#include "burnish/pipeline/report.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/triangle_soup.h"
#include "prepare_input.h"

namespace burnish {

// What stands in reports for the name, and the format, of a surface that no file holds.
inline constexpr const char* kInMemory = "memory";

// Throws Error{unreadable_input} for a model whose area or volume is beyond double precision.
void require_measurable(const std::string& path, double diagonal);

// The model's unit: what was told, or else what the file says of itself. Warns where they differ.
std::optional<ModelUnit> unit_of(const std::optional<ModelUnit>& told, const std::optional<ModelUnit>& of_file, std::vector<std::string>& warnings);

// Reads and welds the file at `path` (or standard input, "-"), moves it to the origin if asked for, and resolves the lengths.
// Tells report.input_format, .unit, .warnings, .groups, .recentred_by and .options. Throws Error as `read_mesh` does, and
// Error{unreadable_input} for a model whose volume is beyond double precision.
TriangleSoup read_input(const std::string& path, bool salvage, const CleanOptions& options, RepairReport& report);

// A welded model at its place: moved to the origin if asked for. Tells report.groups, .recentred_by and .options, whose lengths it resolves.
TriangleSoup placed_input(TriangleSoup input, const std::string& path, const CleanOptions& options, RepairReport& report);

// `prepare_input`, and the verdict on it: false if the input bounds no solid and that was needed, with the reason in
// report.failure; large caps are warned of. `report.before` holds the inspection's defects.
bool prepare_solid(const TriangleSoup& input, const Inspection& inspection, const CleanOptions& options, PreparedInput& prepared,
                   RepairReport& report);

}  // namespace burnish
