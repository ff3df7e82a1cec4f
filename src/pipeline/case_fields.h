// The field files of a case: what their conditions are taken from, and where they go.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "burnish/io/foam_case.h"
#include "burnish/pipeline/initial_condition.h"

namespace burnish {

// A field on its way: chosen before the work begins, so that what cannot be written is known before it.
class CaseFieldFile {
 public:
  // `dry_run`: nothing is created, and an existing field is no error. Throws Error as read_foam_field and OutputFile do.
  CaseFieldFile(const InitialConditionJob& job, const std::string& time, const std::string& name, const std::string& dimensions);
  ~CaseFieldFile();
  CaseFieldFile(const CaseFieldFile&) = delete;
  CaseFieldFile& operator=(const CaseFieldFile&) = delete;

  // Takes the conditions from the template, or makes them for the mesh. Warns of patches that have none.
  void conditions_for(const FoamMesh& mesh, std::vector<std::string>& warnings);
  void set_values(const std::vector<PatchValue>& values, const std::vector<MeshPatch>& patches);
  // To the temporary file; `publish` gives it its name.
  void write(const std::vector<double>& values);
  // All or none of them, as OutputFile::commit does it. A field that is a link to a file is that file: the link stays.
  static void publish(const std::vector<std::unique_ptr<CaseFieldFile>>& fields);

  const CaseField& told() const { return told_; }

 private:
  void remove_folders();

  CaseField told_;
  std::string dimensions_;
  std::optional<FoamField> field_;      // of the template, then with the conditions for the mesh
  std::vector<std::string> made_;       // folders that did not exist
  std::unique_ptr<OutputFile> file_;
};

}  // namespace burnish
