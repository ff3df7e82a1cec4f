// The result on its way out: written to a temporary, read back, verified, mended, published.
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
#include "burnish/pipeline/options.h"
#include "burnish/surface/inspect.h"
#include "surface_maker.h"

namespace burnish {

class CleanedOutput {
 public:
  // `destination` is a path or "-" (standard output, binary STL). Throws Error as OutputFile does, and Error{usage}
  // for a suffix that no format has.
  CleanedOutput(const std::string& destination, bool overwrite);
  // A scratch file of double precision, which is never published.
  CleanedOutput();

  MeshFormat format() const { return options_.format; }
  // What the file will say its coordinates are counted in, if its format can; millimetres otherwise.
  void set_unit(ModelUnit unit) { options_.unit = unit; }
  bool is_scratch() const { return destination_.empty(); }

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

  // True if float32 coordinates of that size deform a surface of such cells visibly.
  bool float_steps_too_coarse() const { return float_steps_too_coarse_; }

  // What to tell the user about a result that is not what it should be.
  Error reason_for_failure(const Defects& after, const ResolvedOptions& options) const;

  // Renames the temporary to the destination, or copies its bytes to standard output.
  void publish();

 private:
  void write(const TriangleSoup& soup);

  std::string destination_;
  MeshWriteOptions options_;
  std::unique_ptr<OutputFile> file_;
  TriangleSoup result_;
  bool float_steps_too_coarse_ = false;
};

}  // namespace burnish
