// The result on its way out: written to a temporary (or rounded as a file would), read back, verified, mended, published.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "burnish/core/error.h"
#include "burnish/core/progress.h"
#include "burnish/io/mesh_io.h"
#include "burnish/io/output_file.h"
#include "burnish/octree/grid_frame.h"
#include "burnish/pipeline/clean.h"
#include "burnish/pipeline/options.h"
#include "burnish/surface/inspect.h"
#include "surface_maker.h"

namespace burnish {

class CleanedOutput {
 public:
  // `destination` is a path or "-" (standard output, binary STL). Throws Error as OutputFile does, and Error{usage}
  // for a suffix that no format has.
  CleanedOutput(const std::string& destination, bool overwrite);
  // Memory, which is never published: what a binary PLY of double precision, or a binary STL, would give back.
  // `keeps_written`: for `take_written`.
  explicit CleanedOutput(Precision precision, bool keeps_written = false);

  // What the file will say its coordinates are in, if its format can; millimetres otherwise.
  void set_unit(ModelUnit unit) { options_.unit = unit; }
  std::string format_name() const;
  bool stores_float32() const { return burnish::stores_float32(options_.format); }
  bool is_in_memory() const { return file_ == nullptr; }

  // What is done to a surface in model coordinates before it is written.
  using Finish = std::function<TriangleSoup(TriangleSoup)>;

  // Makes the surface, finishes it, writes it to the temporary, reads it back, welds and inspects it. What sharpening or rounding
  // to the file's precision broke is mended by the maker and written again, a few times (not if `finish`
  // changes facets). Returns the last inspection of the file as it stands.
  Inspection write_verified(SurfaceMaker& maker, const GridFrame& frame, const Finish& finish, Progress& progress);

  // Writes the surface to the temporary and reads it back, welded.
  const TriangleSoup& write_and_read_back(const TriangleSoup& soup);

  // The surface as read back from the temporary, welded.
  const TriangleSoup& result() const { return result_; }
  TriangleSoup take_result() { return std::move(result_); }
  // The last surface as a file of this format would hold it: its points in the order in which they were written, those of an STL welded.
  TriangleSoup take_written() { return std::move(written_); }

  // True if float32 coordinates of that size deform a surface of such cells visibly.
  bool float_steps_too_coarse() const { return float_steps_too_coarse_; }

  // What to tell the user about a result that is not what it should be.
  Error reason_for_failure(const Defects& after, const ResolvedOptions& options) const;

  // Renames the temporary to the destination, or copies its bytes to standard output.
  void publish();

 private:
  TriangleSoup as_read_back(const TriangleSoup& soup) const;

  std::string destination_;
  MeshWriteOptions options_;
  std::unique_ptr<OutputFile> file_;  // none: memory
  TriangleSoup result_;
  TriangleSoup written_;
  bool keeps_written_ = false;
  bool float_steps_too_coarse_ = false;
};

}  // namespace burnish
