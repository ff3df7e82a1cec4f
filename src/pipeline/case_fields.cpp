#include "case_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace burnish {
namespace {

namespace fs = std::filesystem;

// The file of that name, or with .gz behind it, or none.
std::string existing(const std::string& path) {
  std::error_code ignored;
  for (const char* suffix : {"", ".gz"})
    if (fs::exists(path + suffix, ignored)) return path + suffix;
  return {};
}

std::string without_gz(const std::string& path) { return path.ends_with(".gz") ? path.substr(0, path.size() - 3) : path; }

}  // namespace

CaseFieldFile::CaseFieldFile(const InitialConditionJob& job, const std::string& time, const std::string& name, const std::string& dimensions) : dimensions_(dimensions) {
  const std::string sub = job.region.empty() ? "/" : "/" + job.region + "/";
  const std::string folder = job.case_folder + "/" + time + sub;
  told_.name = name;
  told_.file = existing(folder + name);
  told_.from = told_.file;
  if (told_.file.empty()) {
    told_.file = folder + name;
    told_.from = existing(told_.file + ".orig");
    if (told_.from.empty() && time == "0") told_.from = existing(job.case_folder + "/0.orig" + sub + name);
  }
  if (!told_.from.empty()) field_ = read_foam_field(without_gz(told_.from));
  // What is packed is the file that is replaced, and no other.
  if (field_) field_->format.compressed = told_.file.ends_with(".gz");
  if (job.dry_run) return;
  std::error_code error;
  for (fs::path p = fs::path(told_.file).parent_path(); !p.empty() && !fs::exists(p, error); p = p.parent_path()) made_.push_back(p.string());
  fs::create_directories(fs::path(told_.file).parent_path(), error);
  try {
    file_ = std::make_unique<OutputFile>(told_.file, job.overwrite);
  } catch (...) {
    remove_folders();
    throw;
  }
}

CaseFieldFile::~CaseFieldFile() {
  file_.reset();
  if (!told_.written) remove_folders();
}

void CaseFieldFile::remove_folders() {
  std::error_code ignored;
  for (const std::string& folder : made_) fs::remove(folder, ignored);  // what is in use stays
}

void CaseFieldFile::conditions_for(const FoamMesh& mesh, std::vector<std::string>& warnings) {
  if (!field_) {
    FoamFormat format = mesh.format;
    format.compressed = false;
    field_ = new_foam_field(told_.name, dimensions_, mesh.mesh.patches, format);
    return;
  }
  const auto is_patch = [&](const std::string& name) { return std::any_of(mesh.mesh.patches.begin(), mesh.mesh.patches.end(), [&](const MeshPatch& p) { return p.name == name; }); };
  const std::vector<std::string>& known = field_->patches;
  // Patterns, groups of patches and included files may stand for any.
  if (!std::all_of(known.begin(), known.end(), is_patch) || field_->after.find("#include") != std::string::npos) return;
  for (const MeshPatch& p : mesh.mesh.patches)
    if (p.type != "empty" && std::find(known.begin(), known.end(), p.name) == known.end())
      warnings.push_back(fmt::format("{} has no condition for the patch {}: OpenFOAM will not read it; --patch-value {}=V gives it one", told_.from, p.name, p.name));
}

void CaseFieldFile::set_values(const std::vector<PatchValue>& values, const std::vector<MeshPatch>& patches) {
  for (const PatchValue& v : values) set_patch_value(*field_, v.patch, patches, v.value);
}

void CaseFieldFile::write(const std::vector<double>& values) {
  if (file_) write_foam_field(*file_, *field_, values);
}

void CaseFieldFile::publish(const std::vector<std::unique_ptr<CaseFieldFile>>& fields) {
  std::vector<OutputFile*> files;
  for (const auto& field : fields)
    if (field->file_) files.push_back(field->file_.get());
  OutputFile::commit(files);
  for (const auto& field : fields) field->told_.written = field->file_ != nullptr;
}

}  // namespace burnish
